#include "alidade/run/run.h"

#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <optional>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/base/parallel.h"
#include "alidade/detect/onnx/open_detector.h"
#include "alidade/io/read_ahead.h"
#include "alidade/io/wrappers.h"
#include "alidade/run/calibration/unknown_camera.h"
#include "alidade/run/play/loop.h"
#include "alidade/run/results/mask_writer.h"
#include "alidade/run/sources/any_source.h"
#include "alidade/run/sources/saved_map.h"

namespace alidade {
namespace {

// Description of internal errors; empty: none.
std::string BugOf(const RunRecord& record) {
  std::string bugs;
  for (const StageHealth& stage : record.health.stages) {
    if (stage.bug) bugs += (bugs.empty() ? "" : "; ") + stage.name + " stopped: " + stage.failure;
  }
  if (record.bug) bugs += (bugs.empty() ? "" : "; ") + ("a frame failed: " + WhatOf(record.bug));
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
  claim.owner = OwnerOf(options.source, options.localise);
  claim.overwrite = options.overwrite;
  const std::string usual = "alidade-out/" + source.name + (options.localise ? "-localized" : "");
  claim.path = options.out         ? *options.out
               : options.overwrite ? usual
                                   : FreeFolder(usual, claim.owner);
  for (const auto& file : {options.camera_file, options.config, options.detector}) {
    if (file) claim.inputs.push_back(*file);
  }
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

// Writes the results and moves them to their place. Throws the error, if any, that ended the run.
void LeaveResults(OutputFolder& folder, const Slam& slam, MaskWriter* masks,
                  const std::vector<RunWatcher*>& watchers, RunOutcome& outcome) {
  const RunRecord& record = outcome.record;
  std::exception_ptr failure;
  try {
    outcome.summary = WriteOutputs(folder, slam, record, !record.settings.localise, masks);
    for (RunWatcher* watcher : watchers) watcher->Written(folder.draft());
  } catch (...) {
    failure = std::current_exception();
  }
  const std::string bugs = BugOf(record);
  const bool mapped = outcome.summary.tracked > 0;
  const PlacedResult placed =
      folder.Place(!failure && !record.failure && bugs.empty() && !record.interrupted && mapped);
  outcome.folder = placed.folder;
  if (!placed.folder.empty()) {
    for (RunWatcher* watcher : watchers) watcher->Placed(placed.folder);
  }
  const std::string problem = placed.problem.empty() ? "" : " (" + placed.problem + ")";
  if (failure) Rethrow(failure, problem);
  for (RunWatcher* watcher : watchers) watcher->End(outcome.summary, placed.folder);
  if (record.failure) Rethrow(record.failure, problem);
  if (!bugs.empty())
    throw RunStopped(bugs + " (the results obtained without it are in " + placed.folder + ")" +
                     problem);
  if (record.interrupted) {
    outcome.status = kInterruptedStatus;
    if (!placed.problem.empty()) LogWarning(placed.problem);
  } else if (!mapped) {
    throw Error(ErrorKind::kNothingMapped,
                "nothing could be mapped: " + WhyNothing(record) + problem);
  } else if (!placed.problem.empty()) {
    ThrowInput(placed.problem);
  }
}

}  // namespace

RunOutcome Run(const RunOptions& options, const std::vector<RunWatcher*>& watchers) {
  CheckRunOptions(options);
  RunOutcome outcome;
  RunRecord& record = outcome.record;
  record.source_path = options.source;
  record.profile = options.profile;
  const RunSettings settings = SettingsFrom(options);
  record.settings = settings.slam;
  record.stream = settings.stream;
  record.look = settings.look;
  record.lens_check = settings.lens;
  record.calibrate = settings.calibrate;
  record.untracked.set_look(settings.look);
  ThreadedFrom(options, false);  // invalid words are reported before anything is opened
  RateFrom(options, false);

  cv::setNumThreads(1);  // parallel loops use our own threads
  SetThreadCount(options.threads);
  record.threads = ThreadCount();
  const Warnings warnings(watchers);

  std::optional<SavedMap> saved;
  if (options.load) saved = ReadSavedMap(*options.load);
  SourceOptions wanted = SourceOptionsFrom(options);
  if (saved && !wanted.sensor) wanted.sensor = SensorNamed("the sensor of the map", saved->sensor);
  record.settings.localise = options.localise;
  wanted.color = record.settings.WantsColor();
  std::unique_ptr<FrameSource> source =
      Repeat(OpenAnySource(options.source, wanted), options.repeat);
  record.source = source->Info();
  record.settings.sensor = record.source.sensor;
  record.settings.threaded = ThreadedFrom(options, record.source.kind == "camera");
  OutputFolder folder(ClaimOf(options, record.source));
  outcome.folder = folder.path();
  if (saved && saved->camera.width < record.source.camera.width)
    record.settings.image_width = saved->camera.width;  // the map was made from downscaled images
  LearnCamera(options, wanted, saved ? &saved->camera : nullptr, watchers, record);
  std::shared_ptr<Detector> detector = options.own_detector;
  if (options.detector)
    detector = OpenDetector(*options.detector, record.settings.dynamics.detector);
  Slam slam(record.source.camera, record.settings, detector);
  SayScaledDown(record.source.camera, slam.camera(), record.settings);
  if (saved) slam.Load(*saved);

  std::optional<MaskWriter> masks;
  if (options.write_masks) masks.emplace(folder);
  ReadAhead frames(std::move(source));
  for (RunWatcher* watcher : watchers) watcher->Begin(slam, record, folder.draft());
  RunFrames(frames, RateFrom(options, record.settings.threaded), slam, watchers, record,
            masks ? &*masks : nullptr);
  for (RunWatcher* watcher : watchers) watcher->Finished();
  TakeRefinedCamera(slam, record);
  record.camera.readout = slam.camera().readout;
  record.camera.readout_sigma = slam.readout_sigma();
  record.lens = CheckLens(slam, record.settings, record.lens_check);
  if (const std::string bent = LensInWords(record.lens, slam.camera()); !bent.empty())
    LogWarning(bent);
  record.warnings = warnings.all();
  if (record.failure && record.frames == 0) std::rethrow_exception(record.failure);
  LeaveResults(folder, slam, masks ? &*masks : nullptr, watchers, outcome);
  return outcome;
}

}  // namespace alidade
