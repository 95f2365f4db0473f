#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/nearest_name.h"
#include "alidade/base/parallel.h"
#include "alidade/io/files/trajectory_file.h"
#include "alidade/run/play/loop.h"
#include "alidade/run/recorder/stream_feed.h"
#include "alidade/run/report/result_picture.h"
#include "alidade/run/run.h"
#include "alidade/run/setup/setting_list.h"
#include "alidade/serve/viewer_server.h"
#include "alidade/version.h"
#include "arrays.h"
#include "detector.h"
#include "errors.h"
#include "interruptible.h"
#include "map_value.h"
#include "values.h"

namespace alidade::python {
namespace {

using py::literals::operator""_a;

// Collects the progress of a run, and keeps its map.
class Onlooker : public RunWatcher {
 public:
  void Calibrating(const CalibrateProgress& progress) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    stage_ = "calibrating";
    frames_ = progress.frames;
  }
  void Begin(const WatchedRun& run, const std::string&) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    slam_ = &run.slam;
    total_ = run.setup.source.frames;
    frames_ = 0;
    stage_ = "running";
  }
  void Frame(const SourceFrame& frame, const TrackResult& result) override {
    (void)frame;
    const MapSnapshot map = slam_->Snapshot();
    const std::lock_guard<std::mutex> lock(mutex_);
    ++frames_;
    state_ = result.state;
    keyframes_ = map.keyframe_count();
    points_ = map.landmark_count();
  }
  void Finishing() override {
    const std::lock_guard<std::mutex> lock(mutex_);
    stage_ = "finishing";
  }
  void Finished() override {
    auto saved = std::make_shared<MapValue>(slam_->Saved());
    const std::lock_guard<std::mutex> lock(mutex_);
    map_ = std::move(saved);
  }
  void Placed(const std::string& folder) override { folder_ = folder; }
  void ShownAt(const std::string& address) {
    const std::lock_guard<std::mutex> lock(mutex_);
    viewer_ = address;
  }
  void Warn(const std::string& message) override { KeepWarning(message); }

  py::dict Told() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return py::dict("stage"_a = stage_, "frames"_a = frames_, "total"_a = total_,
                    "state"_a = StateName(state_), "keyframes"_a = keyframes_, "points"_a = points_,
                    "viewer"_a = viewer_);
  }
  std::string folder() const { return folder_; }
  MapHolder map() const { return map_; }

 private:
  mutable std::mutex mutex_;
  const Slam* slam_ = nullptr;
  std::string stage_ = "opening", folder_, viewer_;
  int frames_ = 0, total_ = -1, keyframes_ = 0, points_ = 0;
  TrackState state_ = TrackState::kInitializing;
  MapHolder map_;
};

ServeSettings ViewerSettings(const RunOptions& options) {
  ServeSettings settings;
  if (options.host) settings.host = *options.host;
  if (options.port) {
    settings.port = std::stoi(*options.port);
    settings.port_given = true;
  }
  settings.Check();
  return settings;
}

// That of the run that executes; null: none. Only its address is used.
std::atomic<const Detector*> detector_of_run = nullptr;

// A run that can be stopped while it waits for its turn.
class OneOfMany {
 public:
  void Run(const RunOptions& options, Onlooker& onlooker);
  void Stop() {
    asked_ = true;
    if (running_) RequestInterrupt();
  }

 private:
  std::atomic<bool> asked_{false}, running_{false};
};

void OneOfMany::Run(const RunOptions& options, Onlooker& onlooker) {
  // Warnings, thread counts and interrupts are global to the process, so only one run executes at a
  // time.
  static auto* one_run = new std::timed_mutex;
  std::unique_lock<std::timed_mutex> alone(*one_run, std::defer_lock);
  while (!asked_ && !alone.try_lock_for(std::chrono::milliseconds(50))) {
  }
  if (asked_) return;
  ForgetInterrupts();
  running_ = true;
  detector_of_run = options.own_detector.get();
  if (asked_) RequestInterrupt();
  const int opencv_threads = cv::getNumThreads(), threads = ThreadCount();
  std::vector<RunWatcher*> watchers = {&onlooker};
  std::optional<StreamFeed> feed;
  std::unique_ptr<ViewerServer> server;
  const auto leave = [&] {
    running_ = false;
    detector_of_run = nullptr;
    CollectWarnings();
    cv::setNumThreads(opencv_threads);
    SetThreadCount(threads);
  };
  try {
    const std::optional<std::string> record = RecordFileOf(options);
    if (record || options.viewer) {
      CheckRunOptions(options);
      feed.emplace("alidade " ALIDADE_VERSION, record, SettingsFrom(options).stream);
      watchers.push_back(&*feed);
    }
    if (options.viewer) {
      server = StartViewer(ViewerSettings(options), &*feed, "", options.source);
      onlooker.ShownAt(server->address());
    }
    alidade::Run(options, watchers);
  } catch (...) {
    leave();
    throw;
  }
  leave();
}

// Sets `outcome` ("folder" once known, "map"), also when it raises.
void RunFor(const py::dict& values, const py::object& progress, py::dict outcome) {
  if (const Detector* detector = detector_of_run; detector != nullptr && IsCalledBy(detector))
    ThrowUsage("a detector cannot start a run, which would wait for the detector's own");
  const RunOptions options = OptionsFrom(values);
  Onlooker onlooker;
  OneOfMany run;
  const auto tell = [&] {
    if (!progress.is_none()) progress(onlooker.Told());
  };
  const auto report = [&] {
    if (!onlooker.folder().empty()) outcome["folder"] = PathText(onlooker.folder());
    outcome["map"] = onlooker.map();
  };
  try {
    WorkInterruptibly([&] { run.Run(options, onlooker); }, [&] { run.Stop(); }, tell);
  } catch (...) {
    report();
    throw;
  }
  report();
  tell();
}

}  // namespace

void BindRun(py::module_& core) {
  core.def("run", &RunFor, py::arg("options"), py::arg("progress"), py::arg("outcome"));
  core.def("read_trajectory",
           [](const std::string& path) { return TrajectoryArray(ReadTrajectory(path)); });
  core.def("format_trajectory", [](const py::object& array) {
    return FormatTumTrajectory(TrajectoryOf(array, "trajectory"));
  });
  core.def("setting_names", [] {
    py::dict all;
    for (const auto& [name, value] : RunSettings{}.All()) all[py::str(name)] = value;
    return all;
  });
  core.def("nearest_name", [](const std::string& written, const std::vector<std::string>& known) {
    return NearestName(written, known);
  });
  core.def("result_picture", [](const std::string& folder) -> py::object {
    const std::string bytes = PictureOfResult(folder);
    return bytes.empty() ? py::object(py::none()) : py::object(py::bytes(bytes));
  });
  core.def("setting_list", [] {
    py::list all;
    for (const SettingInfo& info : ListSettings()) {
      all.append(py::dict(py::arg("name") = info.name, py::arg("default") = info.fallback,
                          py::arg("unit") = info.unit, py::arg("range") = info.range,
                          py::arg("meaning") = info.meaning, py::arg("public") = info.is_public));
    }
    return all;
  });
}

}  // namespace alidade::python
