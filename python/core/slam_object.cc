#include "slam_object.h"

#include <limits>
#include <thread>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/detect/onnx/open_detector.h"
#include "alidade/run/setup/run_settings.h"
#include "detector.h"
#include "interruptible.h"
#include "values.h"

namespace alidade::python {
namespace {

using py::literals::operator""_a;

Eigen::Matrix3d RotationFrom(const py::object& pose) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  if (pose.is_none()) return R;
  const auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(pose);
  if (!array || array.ndim() != 2 || array.shape(0) != 4 || array.shape(1) != 4)
    ThrowUsage("mounting must be a pose, (4, 4)");
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) R(row, column) = *array.data(row, column);
  }
  return R;
}

// The settings of the stream, under their names.
SlamViewOptions ViewOptionsFrom(const RunSettings& settings, const Eigen::Matrix3d& R) {
  SlamViewOptions options;
  options.R_camera_rectified = R;
  for (auto& setting : settings.All()) {
    if (setting.first.find("stream.") != std::string::npos)
      options.settings.push_back(std::move(setting));
  }
  return options;
}

}  // namespace

SlamObject::SlamObject(const py::object& camera, const py::dict& options,
                       const py::object& mounting, bool calibrate, const py::object& imu) {
  const RunOptions wanted = OptionsFrom(options);
  const Camera given = CameraFrom(camera);
  const Eigen::Matrix3d R = RotationFrom(mounting);
  std::optional<ImuModel> sensor;
  if (!imu.is_none()) sensor = ImuFrom(imu);
  const py::gil_scoped_release release;
  if (wanted.semidense && wanted.localize)
    ThrowUsage("semidense extends the map, which localize must not change: use one of them");
  const RunSettings all = SettingsFrom(wanted);
  SlamSettings settings = all.slam;
  settings.localize = wanted.localize;
  settings.sensor = SensorNamed("sensor", wanted.sensor.value_or("mono"));
  settings.threaded = ThreadedFrom(wanted, false);
  if (calibrate) settings.EnableSelfCalibration();
  std::shared_ptr<Detector> detector = wanted.own_detector;
  if (wanted.detector) detector = OpenDetector(*wanted.detector, settings.dynamics.detector);
  held_ = std::shared_ptr<Held>(
      new Held(given, R, settings, std::move(detector), ViewOptionsFrom(all, R)), Delete);
  if (sensor) held_->slam.SetImu(*sensor);
}

// The last reference may be dropped with or without the GIL.
void SlamObject::Delete(Held* held) {
  if (held->IsForked()) return;  // its threads, which would have to end, are not in this process
  if (held->settings.threaded && IsCalledBy(held->own_detector)) {
    // This is one of the threads that will be waited for.
    std::thread([held] { delete held; }).detach();
  } else if (PyGILState_Check() != 0) {
    const py::gil_scoped_release release;
    delete held;
  } else {
    delete held;
  }
}

std::shared_ptr<SlamObject::Held> SlamObject::Get() const {
  if (!held_) ThrowUsage("this Slam was closed");
  if (held_->IsForked())
    ThrowUsage(
        "this Slam has threads, which a forked process does not: create it in the process that "
        "uses it, start processes by multiprocessing's \"spawn\", or use schedule=\"inline\" "
        "without view() and record()");
  return held_;
}

std::shared_ptr<SlamObject::Held> SlamObject::GetTurn() const {
  std::shared_ptr<Held> held = Get();
  if (held->own_detector != nullptr && IsCalledBy(held->own_detector))
    ThrowUsage(
        "a detector cannot call this method of its own Slam, which waits for the detector: return "
        "the detections, and call it after track()");
  return held;
}

void SlamObject::Close() {
  if (held_ && !held_->IsForked()) GetTurn();
  held_.reset();
}

TrackedFrame SlamObject::Track(double time, const py::object& image, const py::object& depth,
                               const py::object& right, const py::object& color,
                               const py::object& imu, const std::string& stamp) {
  const std::shared_ptr<Held> held = GetTurn();
  const WrappedImage seen = WrapImage(image, "image"), beside = WrapImage(right, "right"),
                     far = WrapDepth(depth, "depth"), colored = WrapImage(color, "color");
  const std::vector<ImuSample> readings = ImuSamplesOf(imu, "imu");
  const py::gil_scoped_release release;
  const std::lock_guard<std::mutex> lock(held->turn);
  const int number = held->slam.frames();
  RunLog& log = held->log;
  log.stamps.Add({stamp, number});
  const FrameInput input = {time, seen.image, beside.image, far.image, colored.image, readings};
  try {
    const TrackResult result = held->slam.Track(input);
    held->view.Show(input, result);
    return {result, number, time};
  } catch (...) {
    // A rejected frame does not count.
    if (log.stamps.size() > static_cast<size_t>(held->slam.frames())) log.stamps.TakeBack();
    throw;
  }
}

void SlamObject::Load(const MapHolder& map) {
  const std::shared_ptr<Held> held = GetTurn();
  const py::gil_scoped_release release;
  held->slam.Load(*map);
}

void SlamObject::LeaveOut(const py::object& mask) {
  const std::shared_ptr<Held> held = GetTurn();
  const WrappedImage marked = WrapImage(mask, "mask");
  const py::gil_scoped_release release;
  held->slam.LeaveOut(marked.image);
}

void SlamObject::Reset() {
  const std::shared_ptr<Held> held = GetTurn();
  const py::gil_scoped_release release;
  held->slam.Reset();
}

void SlamObject::Forget() {
  const std::shared_ptr<Held> held = GetTurn();
  const py::gil_scoped_release release;
  held->slam.Forget();
}

void SlamObject::SetMapping(bool on) {
  const std::shared_ptr<Held> held = GetTurn();
  const py::gil_scoped_release release;
  held->slam.SetMapping(on);
}

void SlamObject::Finish(double limit) {
  const std::shared_ptr<Held> held = GetTurn();
  const auto work = [&] {
    held->slam.Finish(limit);
    const std::lock_guard<std::mutex> lock(held->turn);
    held->view.Finished();
  };
  WorkInterruptibly(work, [&] { held->slam.CutFinishShort(); });
}

std::string SlamObject::View(int port, const std::string& host) {
  const std::shared_ptr<Held> held = GetTurn();
  const py::gil_scoped_release release;
  const std::lock_guard<std::mutex> lock(held->turn);
  std::string address = held->view.Serve(port, host);
  held->has_threads = true;
  return address;
}

void SlamObject::Record(const std::string& path) {
  const std::shared_ptr<Held> held = GetTurn();
  const py::gil_scoped_release release;
  const std::lock_guard<std::mutex> lock(held->turn);
  held->view.Record(path);
  held->has_threads = true;
}

void SlamObject::EndRecord() {
  const std::shared_ptr<Held> held = GetTurn();
  const py::gil_scoped_release release;
  const std::lock_guard<std::mutex> lock(held->turn);
  held->view.EndRecord();
}

py::object SlamObject::camera() const { return CameraObject(Get()->slam.camera()); }

py::object SlamObject::focal_sigma() const {
  const std::optional<CameraEstimate> found = Get()->slam.camera_found();
  return found ? py::cast(found->focal_sigma) : py::none();
}

py::dict SlamObject::settings() const {
  py::dict all;
  for (const auto& [name, value] : Get()->settings.All()) all[py::str(name)] = value;
  return all;
}

int SlamObject::frames() const { return Get()->slam.frames(); }

MapResults SlamObject::ResultsOfMap(size_t number) const {
  const std::shared_ptr<Held> held = GetTurn();
  const py::gil_scoped_release release;
  const std::lock_guard<std::mutex> lock(held->turn);
  RunResults results = ResultsOf(held->slam, held->log, held->R_camera_rectified);
  if (number >= results.maps.size())
    ThrowUsage("map " + std::to_string(number) +
               " does not exist: maps are numbered from 0, and their number is " +
               std::to_string(results.maps.size()));
  return std::move(results.maps[number]);
}

py::array_t<double> SlamObject::Trajectory(size_t number, bool live) const {
  const MapResults map = ResultsOfMap(number);
  return TrajectoryArray(live ? map.live : map.trajectory);
}

std::string SlamObject::TrajectoryText(size_t number) const {
  return FormatTumTrajectory(ResultsOfMap(number).trajectory);
}

// For each frame: (time, pose or None, its map or None, late).
py::list SlamObject::Frames(int since) const {
  const std::shared_ptr<Held> held = Get();
  std::vector<FramePose> frames;
  {
    const py::gil_scoped_release release;
    frames = held->slam.Trajectory(since);
  }
  py::list all;
  for (const FramePose& frame : frames) {
    const bool placed = frame.tracked;
    all.append(py::make_tuple(
        frame.index, frame.time,
        placed ? py::object(PoseArray(frame.T_world_camera)) : py::object(py::none()),
        placed ? py::object(py::int_(frame.map.value)) : py::object(py::none()), frame.late));
  }
  return all;
}

MapHolder SlamObject::Map() const {
  const std::shared_ptr<Held> held = Get();
  const py::gil_scoped_release release;
  return std::make_shared<MapValue>(held->slam.Saved());
}

py::object SlamObject::Health() const {
  py::dict all;
  for (const StageHealth& stage : Get()->slam.Health().stages)
    all[py::str(stage.name)] =
        stage.running ? py::object(py::none()) : py::object(PathText(stage.failure));
  return all;
}

// Keyword arguments of alidade.Inertial; None without readings.
py::object SlamObject::Inertial() const {
  const InertialReport report = Get()->slam.Inertial();
  if (!report.given) return py::none();
  const auto sigma = [](double value) {
    return value > 0 ? py::object(py::float_(value)) : py::object(py::none());
  };
  const auto vector = [](const Eigen::Vector3d& v) {
    return Table(std::vector<double>{v.x(), v.y(), v.z()});
  };
  return py::dict(
      "samples"_a = report.samples, "metric"_a = report.metric,
      "scale_sigma"_a = sigma(report.scale_sigma),
      "gravity"_a = report.gravity ? py::object(vector(*report.gravity)) : py::object(py::none()),
      "gravity_sigma"_a = sigma(report.gravity_sigma), "gyro_bias"_a = vector(report.bias.gyro),
      "accel_bias"_a = vector(report.bias.accel), "imu"_a = ImuObject(report.model),
      "rotation_sigma"_a = sigma(report.rotation_sigma),
      "time_offset_sigma"_a = sigma(report.time_offset_sigma),
      "left_out"_a = PathText(report.left_out), "missing"_a = PathText(report.missing));
}

py::dict SlamObject::Counts() const {
  const SlamCounts counts = Get()->slam.Counts();
  return py::dict("relocalizations"_a = counts.relocalizations, "loops"_a = counts.loops,
                  "merges"_a = counts.merges, "cuts"_a = counts.cuts,
                  "predicted"_a = counts.predicted, "left_out"_a = counts.left_out);
}

py::dict SlamObject::Times() const {
  const StageTimes times = Get()->slam.Times();
  return py::dict("frame"_a = Table(times.frame), "extract"_a = Table(times.extract),
                  "track"_a = Table(times.track), "map"_a = Table(times.map),
                  "loop"_a = Table(times.loop), "semidense"_a = Table(times.semidense),
                  "detect"_a = Table(times.detect), "dynamics"_a = Table(times.dynamics));
}

py::tuple SlamObject::Features() const {
  std::vector<float> pixels, still;
  std::vector<uint8_t> matched;
  for (const FeatureUse& feature : Get()->slam.Features()) {
    pixels.push_back(feature.x);
    pixels.push_back(feature.y);
    still.push_back(feature.static_probability);
    matched.push_back(feature.matched);
  }
  return py::make_tuple(Table(pixels, 2), Table(matched).attr("astype")("bool"), Table(still));
}

py::object SlamObject::MoverMask() const { return ArrayOf(Get()->slam.MoverMask()); }

py::object SlamObject::Detections() const {
  const std::optional<ShownDetections> shown = Get()->slam.Detections();
  if (!shown) return py::none();
  py::list all;
  for (size_t i = 0; i < shown->detections.size(); ++i) {
    const Detection& d = shown->detections[i];
    all.append(py::make_tuple(shown->names[i].empty() ? py::object(py::int_(d.class_id))
                                                      : py::object(py::str(shown->names[i])),
                              d.score, d.box.x, d.box.y, d.box.width, d.box.height));
  }
  return all;
}

}  // namespace alidade::python
