#include "alidade/io/ros/source/describe_topics.h"

#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/io/files/calibration_beside.h"
#include "alidade/io/files/choose_calibration.h"
#include "alidade/io/ros/camera_info.h"
#include "alidade/io/ros/source/static_frames.h"
#include "alidade/io/ros/source/topic_stamps.h"

namespace alidade {
namespace {

constexpr double kMillimetres = 1000;  // units per meter; REP 118: 16-bit depth is in millimeters

// Calibration from the CameraInfo topics of the chosen images; nullopt: none. Sets `has_right` when
// the baseline is known.
std::optional<Calibration> CalibrationTold(BagFile& bag, const ChosenTopics& chosen,
                                           const std::string& path, bool& has_right) {
  has_right = false;
  if (chosen.info < 0) return std::nullopt;
  std::string topic;
  const auto read = [&](int number) {
    topic = bag.Topics()[static_cast<size_t>(number)].name;
    return FirstInfo(bag, static_cast<size_t>(number));
  };
  try {
    const RosCameraInfo left = read(chosen.info);
    Calibration calibration;
    calibration.origin = path + ", " + topic;
    const std::optional<RawCamera> camera =
        CameraOfInfo(left, chosen.image.rectified, &calibration.told);
    if (!camera) {
      LogWarning(calibration.origin + " is of an uncalibrated camera (K is 0)");
      return std::nullopt;
    }
    calibration.left = *camera;
    if (chosen.right_info >= 0)
      has_right =
          AddRightCamera(left, read(chosen.right_info), chosen.image.rectified, calibration);
    return calibration;
  } catch (const Error& error) {
    throw Error(error.kind(),
                path + ": " + topic + " " + error.what() + " (or use a camera file: --camera)");
  }
}

Sensor SensorFor(const ChosenTopics& chosen, bool has_right, bool has_depth,
                 const SourceOptions& options, const std::string& path) {
  const Sensor best = has_depth ? Sensor::kRgbd : has_right ? Sensor::kStereo : Sensor::kMono;
  const Sensor sensor = options.sensor.value_or(best);
  if (sensor == Sensor::kRgbd && !has_depth) {
    ThrowUsage("--sensor rgbd: " + path + " has no depth that is registered to " +
               chosen.image.name + " (or a `depth_factor` of 0); ?depth=TOPIC selects one");
  }
  if (sensor == Sensor::kStereo && !chosen.right) {
    ThrowUsage("--sensor stereo: " + path + " has no camera to the right of " + chosen.image.name +
               "; ?right=TOPIC selects one");
  }
  if (sensor == Sensor::kStereo && !has_right) {
    ThrowInput(path +
               ": stereo needs the baseline: CameraInfo of both cameras, with P[3] of the right "
               "one, or a camera file with `baseline` or `right` (--camera); or use --sensor mono");
  }
  return sensor;
}

}  // namespace

DescribedTopics DescribeTopics(BagFile& bag, const BagQuery& query, const ChosenTopics& chosen,
                               const std::optional<std::string>& beside,
                               const SourceOptions& options) {
  bool has_right = false;
  std::optional<Calibration> told;
  if (!options.camera_file) {
    told = CalibrationTold(bag, chosen, query.path, has_right);
    if (!told && beside) told = CalibrationBeside(*beside, chosen.image.size, options);
  }
  auto [calibration, guessed, lens_told] = ChooseCalibration(told, chosen.image.size, options);
  has_right = chosen.right && (has_right || calibration.right || calibration.baseline > 0);
  if (!calibration.depth_factor) calibration.depth_factor = kMillimetres;
  const bool has_depth = chosen.depth && *calibration.depth_factor > 0;

  BagImu imu;
  if (!options.imu) imu = ReadBagImu(bag, query, chosen.image);
  // a frame rate in the user's camera file has priority
  const std::optional<double> rate = TopicStamps(bag, chosen.image.topic).Rate();
  if (rate && !(options.camera_file && calibration.fps)) calibration.fps = rate;
  const Sensor sensor = SensorFor(chosen, has_right, has_depth, options, query.path);
  ImagePreparation preparation(calibration, sensor);
  SourceInfo info;
  info.sensor = sensor;
  info.camera = preparation.camera();
  info.camera_guessed = guessed;
  info.lens_told = lens_told;
  info.R_camera_rectified = preparation.R_camera_rectified();
  info.frame_id = chosen.image.frame_id;
  info.T_base_camera = StaticTransform(bag, options.base_frame, info.frame_id);
  info.told = chosen.told;
  if (!imu.told.empty()) info.told += "; " + imu.told;
  if (sensor == Sensor::kMono && chosen.right)
    info.told += "; only one camera is used, because the baseline of the two is unknown";
  if (!calibration.told.empty()) info.told += (info.told.empty() ? "" : "\n") + calibration.told;
  return {std::move(info), std::move(preparation), std::move(imu)};
}

}  // namespace alidade
