#include "alidade/run/run.h"

#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <optional>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/base/parallel.h"
#include "alidade/base/print.h"
#include "alidade/detect/onnx/open_detector.h"
#include "alidade/io/files/camera_file.h"
#include "alidade/io/files/spill_file.h"
#include "alidade/io/read_ahead.h"
#include "alidade/io/wrappers.h"
#include "alidade/run/calibration/lens.h"
#include "alidade/run/calibration/unknown_camera.h"
#include "alidade/run/play/loop.h"
#include "alidade/run/results/mask_writer.h"
#include "alidade/run/setup/mask_file.h"
#include "alidade/run/sources/any_source.h"
#include "alidade/run/sources/inspect.h"
#include "alidade/run/sources/saved_map.h"
#include "alidade/system/prepare.h"

namespace alidade {
namespace {

// What went wrong by no fault of the recording's; empty: nothing.
std::string BugOf(const RunLog& log) {
  std::string bugs;
  for (const StageHealth& stage : log.health.stages) {
    if (stage.bug) bugs += (bugs.empty() ? "" : "; ") + stage.name + " stopped: " + stage.failure;
  }
  if (log.bug) bugs += (bugs.empty() ? "" : "; ") + ("a frame failed: " + WhatOf(log.bug));
  return bugs;
}

std::string SizeOf(const Camera& camera) {
  return std::to_string(camera.width) + "x" + std::to_string(camera.height);
}

// Unless it was disabled by a setting.
void SayScaledDown(const Camera& given, const Camera& used, const SlamSettings& settings) {
  if (settings.image_width != 0 || used.width == given.width) return;
  LogWarning("images of " + SizeOf(given) + " are downscaled to " + SizeOf(used) +
             ": larger ones take longer without gain (--set max_image_side=0 keeps their size)");
}

std::string FovInWords(const Camera& camera) {
  char text[40];
  PrintTo(text, sizeof(text), "%.1f degrees", FovDegrees(camera));
  return text;
}

// Why inertial readings are not used, or what they do not tell.
void TellOfImu(const InertialReport& report) {
  if (!report.given) return;
  for (const std::string& sentence : {report.left_out, report.missing}) {
    if (!sentence.empty()) LogWarning(sentence);
  }
}

// Collects the warnings of the library while it exists.
class Warnings {
 public:
  explicit Warnings(const std::vector<RunWatcher*>& watchers) {
    SetWarningListener([this, &watchers](const std::string& message) {
      const std::lock_guard<std::mutex> lock(mutex_);
      all_.push_back(message);
      for (RunWatcher* watcher : watchers) watcher->Warn(message);
    });
  }
  ~Warnings() { SetWarningListener(nullptr); }
  Warnings(const Warnings&) = delete;
  Warnings& operator=(const Warnings&) = delete;

  std::vector<std::string> all() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return all_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> all_;
};

// Creates and locks the result folder before the run.
OutputClaim ClaimOf(const RunOptions& options, const SourceInfo& source) {
  OutputClaim claim;
  claim.owner = OwnerOf(options.source, options.localize);
  claim.overwrite = options.overwrite;
  const std::string usual = "alidade-out/" + source.name + (options.localize ? "-localized" : "");
  claim.path = options.out         ? *options.out
               : options.overwrite ? usual
                                   : FreeFolder(usual, claim.owner);
  if (options.camera_file) claim.inputs.push_back(CameraFilePath(*options.camera_file));
  for (const auto& file : {options.config, options.detector}) {
    if (file) claim.inputs.push_back(*file);
  }
  if (options.imu && options.imu != kNoImu) claim.inputs.push_back(*options.imu);
  if (options.load) claim.inputs.push_back(SavedMapPath(*options.load));
  return claim;
}

// Rethrows the error that ended the run, with `problem` (may be empty) appended.
[[noreturn]] void Rethrow(const std::exception_ptr& failure, const std::string& problem) {
  try {
    std::rethrow_exception(failure);
  } catch (const Error& error) {
    throw Error(error.kind(), error.what() + problem);
  }
}

// nullopt: Ctrl-C ended the wait for a live source's first images.
std::optional<InspectedSource> OpenUnlessInterrupted(const std::string& source,
                                                     SourceOptions& wanted) {
  try {
    return OpenInspected(source, wanted);
  } catch (const Error& error) {
    if (!Interrupted()) throw;
    LogWarning(error.what());
    return std::nullopt;
  }
}

// With the sensor of the map that is continued. In a map that is only localized in, any will do:
// that of the recording, but for a map of one camera, whose unit need not be the meter.
std::optional<InspectedSource> OpenFor(const SavedMap* saved, const RunOptions& options,
                                       SourceOptions& wanted) {
  if (!saved || wanted.sensor) return OpenUnlessInterrupted(options.source, wanted);
  const Sensor of_map = SensorNamed("the sensor of the map", saved->sensor);
  wanted.sensor = of_map;
  try {
    return OpenUnlessInterrupted(options.source, wanted);
  } catch (const Error&) {
    if (!options.localize || of_map == Sensor::kMono) throw;
    wanted.sensor.reset();
    return OpenUnlessInterrupted(options.source, wanted);
  }
}

// Sets the width of the images to that of the map's. Another camera than the map's is brought to
// its resolution, so that a landmark has the size in pixels that it has in the map.
void FitImagesToMap(const SavedMap& saved, const Camera& camera, RunSetup& setup) {
  SlamSettings& settings = setup.settings.slam;
  if (saved.camera.width < camera.width)
    settings.image_width = saved.camera.width;  // it was made from images scaled down
  if (!settings.localize || CameraShift(saved.camera, CameraInUse(camera, settings)) < kSameCamera)
    return;
  const int width = WidthAtResolutionOf(saved.camera, camera, settings.max_image_side);
  settings.image_width = width;
  const Camera used = CameraInUse(camera, settings);
  int& features = settings.tracker.extractor.features;
  features = FeaturesAsDenseAs(saved.camera, used, features);
  settings.refine.enabled = false;  // it would change the keyframes of the map
  std::string& told = setup.source.told;
  told += std::string(told.empty() ? "" : "\n") + "The map is of another camera (" +
          SizeOf(saved.camera) + ", " + FovInWords(saved.camera) + "); images of " +
          SizeOf(camera) + ", " + FovInWords(camera) + " are scaled to its resolution, " +
          SizeOf(used);
}

// Whether images of unknown calibration may be the map's camera's: they have its shape.
bool MayBeOfMap(const SavedMap& saved, const Camera& camera) {
  return saved.camera.ScaledToWidth(camera.width).height == camera.height;
}

// Writes the results and moves them to their place. Throws the error, if any, that ended the run.
void LeaveResults(OutputFolder& folder, const Slam& slam, MaskWriter* masks,
                  const std::vector<RunWatcher*>& watchers, RunOutcome& outcome) {
  const RunLog& log = outcome.log;
  std::exception_ptr failure;
  try {
    outcome.summary = WriteOutputs(folder, slam, outcome.setup, outcome.camera, log, masks);
    for (RunWatcher* watcher : watchers) watcher->Written(folder.draft());
  } catch (...) {
    failure = std::current_exception();
  }
  const std::string bugs = BugOf(log);
  const bool mapped = outcome.summary.tracked > 0;
  const PlacedResult placed =
      folder.Place(!failure && !log.failure && bugs.empty() && !log.interrupted && mapped);
  outcome.folder = placed.folder;
  if (!placed.folder.empty()) {
    for (RunWatcher* watcher : watchers) watcher->Placed(placed.folder);
  }
  const std::string problem = placed.problem.empty() ? "" : " (" + placed.problem + ")";
  if (failure) Rethrow(failure, problem);
  for (RunWatcher* watcher : watchers) watcher->End(outcome.summary, placed.folder);
  if (log.failure) Rethrow(log.failure, problem);
  if (!bugs.empty())
    throw RunStopped(bugs + " (the results obtained without it are in " + placed.folder + ")" +
                     problem);
  if (log.interrupted) {
    outcome.status = kInterruptedStatus;
    if (!placed.problem.empty()) LogWarning(placed.problem);
  } else if (!mapped) {
    throw Error(ErrorKind::kNothingMapped, "nothing could be mapped: " + WhyNothing(log) + problem);
  } else if (!placed.problem.empty()) {
    ThrowInput(placed.problem);
  }
}

}  // namespace

RunOutcome Run(const RunOptions& options, const std::vector<RunWatcher*>& watchers) {
  CheckRunOptions(options);
  RunOutcome outcome;
  RunSetup& setup = outcome.setup;
  CameraFinding& finding = outcome.camera;
  RunLog& log = outcome.log;
  setup.source_path = SourceToShow(options.source);
  setup.profile = options.profile;
  setup.repeat_words = RepeatWords(options);
  setup.settings = SettingsFrom(options);
  SlamSettings& settings = setup.settings.slam;
  log.untracked.set_look(setup.settings.look);
  ThreadedFrom(options, false);  // slips in words come out before anything is opened
  RateFrom(options, false, false);

  cv::setNumThreads(1);  // parallel loops use our own threads
  SetThreadCount(options.threads);
  setup.threads = ThreadCount();
  const Warnings warnings(watchers);

  std::optional<SavedMap> saved;
  if (options.load) saved = ReadSavedMap(*options.load);
  SourceOptions wanted = SourceOptionsFrom(options);
  settings.localize = options.localize;
  wanted.color = settings.WantsColor();
  wanted.interrupted = Interrupted;
  std::optional<InspectedSource> inspected = OpenFor(saved ? &*saved : nullptr, options, wanted);
  if (!inspected) {
    outcome.status = kInterruptedStatus;
    return outcome;
  }
  std::unique_ptr<FrameSource> source = Repeat(std::move(inspected->source), options.repeat);
  setup.source = source->Info();
  if (options.imu == kNoImu) setup.source.imu.reset();
  setup.source.told = inspected->told;
  setup.reading = wanted;
  settings.sensor = setup.source.sensor;
  const bool live = setup.source.live;
  settings.threaded = ThreadedFrom(options, live);
  const Rate rate = RateFrom(options, settings.threaded, live);
  settings.wait_for_mapping = rate.kind == Rate::Kind::kMax && !live;
  OutputFolder folder(ClaimOf(options, setup.source));
  outcome.folder = folder.path();
  const auto go_on = [&](const CalibrateProgress& progress) {
    for (RunWatcher* watcher : watchers) watcher->Calibrating(progress);
    return !Interrupted();
  };
  const bool of_map = saved && (!options.localize || MayBeOfMap(*saved, setup.source.camera));
  finding = LearnCamera(options, wanted, of_map ? &saved->camera : nullptr, go_on, setup);
  if (saved) FitImagesToMap(*saved, finding.camera, setup);
  setup.map_in_meters = saved && saved->sensor != NameOf(Sensor::kMono);
  std::shared_ptr<Detector> detector = options.own_detector;
  if (options.detector) detector = OpenDetector(*options.detector, settings.dynamics.detector);
  Slam slam(finding.camera, settings, detector);
  if (options.mask) slam.LeaveOut(ReadMaskFile(*options.mask, finding.camera));
  if (setup.source.imu) slam.SetImu(*setup.source.imu);
  SayScaledDown(finding.camera, slam.camera(), settings);
  if (saved) slam.Load(*saved);
  const std::shared_ptr<ByteStore> store = MakeSpillFile(folder.draft());
  slam.KeepFramesIn(store);
  log.stamps.KeepIn(store);

  std::optional<MaskWriter> masks;
  if (options.write_masks) masks.emplace(folder);
  ReadAhead frames(std::move(source));
  for (RunWatcher* watcher : watchers)
    watcher->Begin({slam, setup, finding, log, folder.path()}, folder.draft());
  RunFrames(frames, rate, settings, slam, watchers, log, masks ? &*masks : nullptr);
  for (RunWatcher* watcher : watchers) watcher->Finished();
  TakeRefinedCamera(slam, setup, log.frames, finding);
  finding.readout = slam.camera().readout;
  finding.readout_sigma = slam.readout_sigma();
  finding.lens = CheckLens(slam, settings, setup.settings.lens);
  if (const std::string bent = LensInWords(finding.lens, slam.camera()); !bent.empty())
    LogWarning(bent);
  TellOfImu(slam.Inertial());
  log.warnings = warnings.all();
  if (log.failure && log.frames == 0) std::rethrow_exception(log.failure);
  LeaveResults(folder, slam, masks ? &*masks : nullptr, watchers, outcome);
  return outcome;
}

}  // namespace alidade
