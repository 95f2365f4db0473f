#include "bench/dynamic/live.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <thread>

#include "alidade/base/timing.h"
#include "bench/measure/reference.h"

namespace alidade::bench {
namespace {

constexpr size_t kMostFrames = 300;

struct LiveRun {
  StageTimes times;
  double seconds = 0;  // from the first frame to the last
  int tracked = 0;
};

LiveRun Play(const DynamicScene& scene, SlamSettings settings, DynamicsMode mode,
             const std::shared_ptr<Detector>& detector) {
  settings.threaded = true;
  settings.dynamics.mode = mode;
  Slam slam(scene.info.camera, settings, mode == DynamicsMode::kFull ? detector : nullptr);
  LiveRun run;
  const size_t count = std::min(scene.frames.size(), kMostFrames);
  const Stopwatch clock;
  for (size_t i = 0; i < count; ++i) {
    const SourceFrame& frame = scene.frames[i];
    const double ahead = frame.time - scene.frames[0].time - clock.Milliseconds() * 1e-3;
    if (ahead > 0) std::this_thread::sleep_for(std::chrono::duration<double>(ahead));
    const TrackResult result =
        slam.Track({frame.time, frame.image, frame.right, frame.depth, frame.color});
    run.tracked += result.state == TrackState::kTracking;
  }
  run.seconds = clock.Milliseconds() * 1e-3;
  slam.Finish();
  run.times = slam.Times();
  return run;
}

double MedianOfSamples(const std::vector<double>& samples) {
  return samples.empty() ? std::numeric_limits<double>::quiet_NaN() : Summarise(samples).median;
}

std::vector<double> RowOf(const LiveRun& run, double off, double u) {
  const StageTimes& times = run.times;
  const double frame = MedianOfSamples(times.frame);
  return {frame,
          frame / u,
          frame / off,
          MedianOfSamples(times.extract),
          MedianOfSamples(times.track),
          MedianOfSamples(times.dynamics),
          MedianOfSamples(times.detect),
          static_cast<double>(times.detect.size()) / run.seconds,
          static_cast<double>(run.tracked)};
}

}  // namespace

Table BenchDynamicLive(const DynamicScene& scene, const Case& of, const SlamSettings& settings,
                       const std::shared_ptr<Detector>& detector, std::vector<double>& u) {
  constexpr int kRounds = 3, kTurns = 10;
  std::vector<DynamicsMode> modes{DynamicsMode::kOff, DynamicsMode::kGeometry};
  if (detector) modes.push_back(DynamicsMode::kFull);
  Table table{"5. threaded, fed at the recording's own rate",
              {{"frame", "ms"},
               {"frame", "U"},
               {"frame_to_off"},
               {"extract", "ms"},
               {"track", "ms"},
               {"dynamics", "ms"},
               {"detect", "ms"},
               {"detections", "1/s"},
               {"tracked"}}};
  Reference reference;
  std::vector<std::vector<std::vector<double>>> rows(modes.size());  // mode, round, column
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> u_now;
    for (size_t i = 0; i < kTurns; ++i)
      u_now.push_back(reference.Run(scene.frames[i % scene.frames.size()].image));
    u.insert(u.end(), u_now.begin(), u_now.end());
    // Who goes first changes: the machine may be busier at one time than at another.
    std::vector<LiveRun> runs(modes.size());
    for (size_t i = 0; i < modes.size(); ++i) {
      const size_t turn = (i + static_cast<size_t>(round)) % modes.size();
      runs[turn] = Play(scene, settings, modes[turn], detector);
    }
    const double off = MedianOfSamples(runs[0].times.frame);
    for (size_t i = 0; i < modes.size(); ++i)
      rows[i].push_back(RowOf(runs[i], off, Summarise(u_now).median));
  }
  for (size_t i = 0; i < modes.size(); ++i) {
    std::vector<double> row;
    for (size_t column = 0; column < table.columns.size(); ++column) {
      std::vector<double> values;
      for (const auto& of_round : rows[i]) values.push_back(of_round[column]);
      row.push_back(MedianOfSamples(values));
    }
    Line line{of, std::move(row)};
    line.of.variant = NameOf(modes[i]);
    line.of.name += ", live, " + line.of.variant;
    line.of.frames = static_cast<int>(std::min(scene.frames.size(), kMostFrames));
    table.lines.push_back(std::move(line));
  }
  table.note = "Medians of " + std::to_string(kRounds) +
               " rounds in turns. detect: the network's time for one frame, detections: how many "
               "frames it was given.";
  return table;
}

}  // namespace alidade::bench
