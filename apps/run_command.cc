// alidade run: a recording or camera in, a trajectory and a map out.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/parallel.h"
#include "alidade/detect/onnx/open_detector.h"
#include "alidade/io/read_ahead.h"
#include "alidade/io/wrappers.h"
#include "alidade/system/slam.h"
#include "any_source.h"
#include "commands.h"
#include "mask_writer.h"
#include "run_loop.h"
#include "run_options.h"
#include "run_outputs.h"
#include "run_record.h"
#include "saved_map.h"
#include "terminal.h"

namespace alidade {
namespace {

void Say(const RunSummary& summary, const RunRecord& record, const std::string& folder) {
  std::string shape;
  if (summary.shape_points > 0) {
    shape = ", " + std::to_string(summary.shape_points) + " points of shape";
  } else if (record.settings.semidense.enabled && !record.settings.localise) {
    shape = ", no shape (too little was seen from new keyframes)";
  }
  std::printf("%d of %d frames tracked, %d keyframes, %d landmarks%s, path %.2f %s\n%s in %s\n",
              summary.tracked, summary.frames, summary.keyframes, summary.landmarks, shape.c_str(),
              summary.path_length, record.settings.sensor == Sensor::kMono ? "map units" : "m",
              record.interrupted ? "Interrupted: results so far" : "Results", folder.c_str());
}

// What went wrong by no fault of the recording's; empty: nothing.
std::string BugOf(const RunRecord& record) {
  std::string bugs;
  for (const StageHealth& stage : record.health.stages) {
    if (stage.bug) bugs += (bugs.empty() ? "" : "; ") + stage.name + " stopped: " + stage.failure;
  }
  if (record.bug) bugs += (bugs.empty() ? "" : "; ") + ("a frame failed: " + WhatOf(record.bug));
  return bugs;
}

int Run(const RunOptions& options) {
  CheckRunOptions(options);
  RunRecord record;
  record.source_path = options.source;
  record.profile = options.profile;
  record.settings = SettingsFrom(options);
  ThreadedFrom(options, false);  // slips in words come out before anything is opened
  RateFrom(options, false);

  CatchInterrupts();
  cv::setNumThreads(1);  // the loops are ours
  SetThreadCount(options.threads);
  record.threads = ThreadCount();
  Terminal terminal(options.quiet);

  std::optional<SavedMap> saved;
  if (options.load) saved = ReadSavedMap(*options.load);
  SourceOptions wanted = SourceOptionsFrom(options);
  if (saved && !wanted.sensor) wanted.sensor = SensorNamed("the map's sensor", saved->sensor);
  record.settings.localise = options.localise;
  wanted.color = record.settings.WantsColor();
  std::unique_ptr<FrameSource> source =
      Repeat(OpenAnySource(options.source, wanted), options.repeat);
  record.source = source->Info();
  record.settings.sensor = record.source.sensor;
  record.settings.threaded = ThreadedFrom(options, record.source.kind == "camera");
  if (saved && saved->camera.width < record.source.camera.width)
    record.settings.image_width = saved->camera.width;  // it was made from images scaled down
  std::shared_ptr<Detector> detector;
  if (options.detector)
    detector = OpenDetector(*options.detector, record.settings.dynamics.detector);
  Slam slam(record.source.camera, record.settings, detector);
  if (saved) slam.Load(*saved);
  OutputFolder folder(options.out.value_or("alidade-out/" + record.source.name),
                      options.load ? SavedMapPath(*options.load) : std::string());

  std::optional<MaskWriter> masks;
  if (options.write_masks) masks.emplace(folder);
  ReadAhead frames(std::move(source));
  RunFrames(frames, RateFrom(options, record.settings.threaded), slam, terminal, record,
            masks ? &*masks : nullptr);
  record.warnings = terminal.warnings();
  if (record.failure && record.frames == 0) {
    if (masks) masks->Discard();
    folder.Remove();
    std::rethrow_exception(record.failure);
  }
  const RunSummary summary =
      WriteOutputs(folder, slam, record, !options.localise, masks ? &*masks : nullptr);
  if (!options.quiet) Say(summary, record, folder.path());
  if (record.failure) std::rethrow_exception(record.failure);
  if (const std::string bugs = BugOf(record); !bugs.empty())
    throw std::runtime_error(bugs + " (what could be done without is in " + folder.path() + ")");
  if (record.interrupted) return kInterruptedStatus;
  if (summary.tracked == 0) {
    throw Error(ErrorKind::kNothingMapped, "nothing could be mapped: " + WhyNothing(record));
  }
  return 0;
}

}  // namespace

void AddRunCommand(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("run", "Track a recording, video or camera and map what it sees");
  auto options = std::make_shared<RunOptions>();
  AddRunOptions(*command, *options);
  command->callback([options, &action] { action = [options] { return Run(*options); }; });
}

void AddLocalizeCommand(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("localize", "Find the poses of a recording in a saved map");
  auto options = std::make_shared<RunOptions>();
  AddLocalizeOptions(*command, *options);
  command->callback([options, &action] { action = [options] { return Run(*options); }; });
}

}  // namespace alidade
