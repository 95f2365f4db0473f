// alidade run: a recording or camera in, a trajectory and a map out.
#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <opencv2/core.hpp>
#include <thread>

#include <unistd.h>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/base/parallel.h"
#include "alidade/io/files/open_source.h"
#include "alidade/slam.h"
#include "arguments.h"
#include "commands.h"
#include "run_outputs.h"
#include "synth_source.h"

namespace alidade {
namespace {

struct RunArguments {
  std::string source;
  std::string sensor, camera_file, profile = "desktop", config, schedule, rate, out;
  double fov = 0;
  std::vector<std::string> settings;
  int threads = 0, first = 0, last = -1, repeat = 1;
  uint64_t seed = 1;
  bool quiet = false;
};

volatile std::sig_atomic_t g_interrupted = 0;
void Interrupt(int) { g_interrupted = 1; }

std::unique_ptr<FrameSource> Open(const RunArguments& arguments) {
  SourceOptions options;
  if (!arguments.sensor.empty()) {
    options.sensor = Choice<Sensor>("--sensor", arguments.sensor,
                                    {{"mono", Sensor::kMono}, {"stereo", Sensor::kStereo}, {"rgbd", Sensor::kRgbd}});
  }
  if (!arguments.camera_file.empty()) options.camera_file = arguments.camera_file;
  if (arguments.fov > 0) options.fov_degrees = arguments.fov;
  options.first = arguments.first;
  options.last = arguments.last;
  if (IsSynthSource(arguments.source)) return OpenSynthSource(arguments.source, options);
  return OpenSource(arguments.source, options);
}

SlamSettings SettingsFrom(const RunArguments& arguments, Sensor sensor, bool live) {
  SlamSettings settings;
  settings.sensor = sensor;
  settings.seed = arguments.seed;
  settings.ApplyProfile(arguments.profile);
  for (const std::string& assignment : arguments.settings) {
    const size_t equals = assignment.find('=');
    if (equals == std::string::npos) ThrowUsage("--set " + assignment + ": expected name=value");
    settings.Set(assignment.substr(0, equals), assignment.substr(equals + 1));
  }
  settings.threaded = arguments.schedule.empty()
                          ? live
                          : Choice<bool>("--schedule", arguments.schedule, {{"inline", false}, {"threaded", true}});
  settings.Check();
  return settings;
}

// Seconds of play per second of recording are 1 (realtime), as fast as it goes (0), or a fixed frame rate.
struct Pace {
  bool realtime = false;
  double fps = 0;
};

Pace PaceFrom(const RunArguments& arguments, bool threaded) {
  if (arguments.rate.empty()) return {threaded, 0};
  if (arguments.rate == "realtime") return {true, 0};
  if (arguments.rate == "max") return {};
  char* end = nullptr;
  const double fps = std::strtod(arguments.rate.c_str(), &end);
  if (*end != '\0' || !(fps > 0)) ThrowUsage("--rate is realtime, max or frames per second, not '" + arguments.rate + "'");
  return {false, fps};
}

int Run(const RunArguments& arguments) {
  cv::setNumThreads(1);
  SetThreadCount(arguments.threads);
  std::vector<std::string> warnings;
  SetWarningListener([&](const std::string& message) {
    warnings.push_back(message);
    if (!arguments.quiet) std::fprintf(stderr, "alidade: warning: %s\n", message.c_str());
  });
  const std::unique_ptr<FrameSource> source = Open(arguments);
  const SourceInfo info = source->Info();
  const bool live = info.kind == "camera";
  const SlamSettings settings = SettingsFrom(arguments, info.sensor, live);
  const Pace pace = PaceFrom(arguments, settings.threaded);
  const std::string out = arguments.out.empty() ? "alidade-out/" + info.name : arguments.out;
  PrepareOutput(out);

  Slam slam(info.camera, settings);
  RunRecord record;
  record.source = info;
  record.source_path = arguments.source;
  record.sensor = info.sensor;
  record.settings = settings;
  record.profile = arguments.profile;
  record.threads = ThreadCount();
  std::signal(SIGINT, Interrupt);
  std::signal(SIGTERM, Interrupt);

  const bool progress = !arguments.quiet && isatty(STDERR_FILENO);
  const Stopwatch clock;
  const double cpu_start = ProcessCpuSeconds();
  std::optional<double> first_time;
  const char* reason = "";
  while (!g_interrupted) {
    std::optional<SourceFrame> frame = source->Next();
    if (!frame) break;
    ++record.frames;
    if (!frame->problem.empty()) {
      LogWarning("frame " + std::to_string(frame->number) + " skipped: " + frame->problem);
      ++record.dropped;
      continue;
    }
    if (!first_time) first_time = frame->time;
    const double due = pace.realtime ? frame->time - *first_time : pace.fps > 0 ? (record.frames - 1) / pace.fps : 0;
    const double ahead = due - clock.Milliseconds() * 1e-3;
    if (ahead > 0) std::this_thread::sleep_for(std::chrono::duration<double>(ahead));
    const TrackResult result = slam.Track({frame->time, frame->image, frame->right, frame->depth});
    record.stamps.push_back(frame->stamp);
    record.numbers.push_back(frame->number);
    if (result.state != TrackState::kTracking) reason = result.reason;
    if (progress && record.frames % 10 == 0) {
      const MapSnapshot map = slam.Snapshot();
      std::fprintf(stderr, "\rframe %d%s  %s  %d matches  %d keyframes  %d landmarks   ", record.frames,
                   info.frames > 0 ? ("/" + std::to_string(info.frames)).c_str() : "",
                   result.state == TrackState::kTracking ? "tracking" : result.state == TrackState::kLost ? "lost" : "initialising",
                   result.matches, map.keyframe_count(), map.landmark_count());
    }
  }
  slam.Finish();
  record.wall_s = clock.Milliseconds() * 1e-3;
  record.cpu_s = ProcessCpuSeconds() - cpu_start;
  if (progress) std::fprintf(stderr, "\n");
  record.warnings = warnings;
  const int tracked = WriteOutputs(out, slam, record);
  if (!arguments.quiet) {
    std::printf("%d of %d frames tracked, %d keyframes, %d landmarks: %s\n", tracked, record.frames,
                slam.Snapshot().keyframe_count(), slam.Snapshot().landmark_count(), out.c_str());
  }
  if (g_interrupted) return 130;
  if (tracked == 0) throw Error(ErrorKind::kNothingMapped, "nothing could be mapped: " + std::string(reason));
  return 0;
}

}  // namespace

void AddRunCommand(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("run", "Track a recording, video or camera and map what it sees");
  auto arguments = std::make_shared<RunArguments>();
  command->add_option("SOURCE", arguments->source, "Folder (TUM RGB-D, EuRoC, KITTI, images), video file, camera:0 or synth:SCENE?frames=N&...")->required();
  command->add_option("--sensor", arguments->sensor, "mono, stereo or rgbd; default: what the recording has");
  command->add_option("--camera", arguments->camera_file, "Calibration (camera.yaml) instead of the recording's own");
  command->add_option("--fov", arguments->fov, "Horizontal field of view, degrees, when there is no calibration (66)");
  command->add_option("--profile", arguments->profile, "desktop (1000 features, full size) or phone (500, 400 pixels wide)");
  command->add_option("--set", arguments->settings, "One setting, name=value; may be given many times")->take_all();
  command->add_option("--schedule", arguments->schedule, "inline (same result every time) or threaded (live)");
  command->add_option("--rate", arguments->rate, "realtime, max or frames per second");
  command->add_option("--threads", arguments->threads, "Threads for parallel loops; 0 = all cores");
  command->add_option("--seed", arguments->seed, "Seed of every random choice");
  command->add_option("--out", arguments->out, "Folder for the results (alidade-out/NAME)");
  command->add_option("--first", arguments->first, "First frame, counted from 0");
  command->add_option("--last", arguments->last, "Last frame, included");
  command->add_flag("--quiet", arguments->quiet, "Say nothing but errors");
  command->callback([arguments, &action] { action = [arguments] { return Run(*arguments); }; });
}

}  // namespace alidade
