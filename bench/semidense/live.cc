// What semi-dense mapping costs the one who waits for poses.
#include <algorithm>
#include <chrono>
#include <thread>

#include "alidade/base/timing.h"
#include "alidade/run/sources/any_source.h"
#include "alidade/semidense/semidense_mapper.h"
#include "alidade/slam.h"
#include "bench/measure/reference.h"
#include "bench/semidense/semidense.h"

namespace alidade::bench {
namespace {

struct DenseRun {
  double frame = 0;   // milliseconds Track() took, median of the frames that were tracked
  double share = 0;   // of the frames tracked
  double cpu = 0;     // milliseconds of all threads, to the end of Finish()
  int keyframes = 0;  // in the map at the end
  int most_behind = 0;
};

// Images alone, as one camera gives them.
Recording LoadImages(const std::string& source, int count) {
  SourceOptions options;
  options.sensor = Sensor::kMono;
  options.last = count - 1;
  const auto opened = OpenAnySource(source, options);
  Recording recording{source, opened->Info(), {}};
  while (auto frame = opened->Next()) {
    if (!frame->problem.empty()) continue;
    frame->true_depth.release();
    recording.frames.push_back(std::move(*frame));
  }
  return recording;
}

DenseRun Play(const Recording& recording, bool dense) {
  SlamSettings settings;
  settings.sensor = Sensor::kMono;
  settings.threaded = true;
  settings.semidense.enabled = dense;
  Slam slam(recording.info.camera, settings);
  std::vector<double> times;
  const double cpu_start = ProcessCpuSeconds();
  const Stopwatch clock;
  for (const SourceFrame& frame : recording.frames) {
    const double due = frame.time - recording.frames[0].time;
    const double ahead = due - clock.Milliseconds() * 1e-3;
    if (ahead > 0) std::this_thread::sleep_for(std::chrono::duration<double>(ahead));
    const Stopwatch watch;
    const TrackResult result = slam.Track({frame.time, frame.image, {}, {}});
    if (result.state == TrackState::kTracking) times.push_back(watch.Milliseconds());
  }
  slam.Finish();
  DenseRun run;
  run.cpu = (ProcessCpuSeconds() - cpu_start) * 1e3;
  run.frame = Summarise(times).median;
  run.share = static_cast<double>(times.size()) / static_cast<double>(recording.frames.size());
  run.keyframes = slam.Snapshot().keyframe_count();
  run.most_behind = slam.SemiDense().most_behind;
  return run;
}

}  // namespace

Table BenchSemiDenseLive(const std::string& source, int frames, std::vector<double>& u) {
  constexpr int kRounds = 3, kTurns = 10;
  const Recording recording = LoadImages(source, frames);
  Reference reference;
  Table table{"one camera, threaded, fed at the recording's own rate",
              {{"track_without", "ms"},
               {"track_with", "ms"},
               {"ratio"},
               {"most_waiting"},
               {"keyframes"},
               {"cpu_per_keyframe", "ms"},
               {"tracked", "%"}}};
  table.note =
      "track: median of Track() with and without semi-dense mapping. most_waiting: keyframes that "
      "waited for it at once. cpu_per_keyframe: what it adds, for each keyframe of the map.";
  const auto line_of = [&](const std::string& variant, std::vector<double> values) {
    Case of{ShortName(source) + ", live, " + variant, "mono", "desktop", source, variant};
    of.frames = static_cast<int>(recording.frames.size());
    return Line{std::move(of), std::move(values)};
  };
  for (int round = 1; round <= kRounds; ++round) {
    for (size_t i = 0; i < kTurns; ++i)
      u.push_back(reference.Run(recording.frames[i % recording.frames.size()].image));
    // Who goes first changes: the machine may be busier at one time than at another.
    DenseRun without, with;
    if (round % 2 == 1) without = Play(recording, false);
    with = Play(recording, true);
    if (round % 2 == 0) without = Play(recording, false);
    table.lines.push_back(
        line_of("round " + std::to_string(round),
                {without.frame, with.frame, with.frame / without.frame,
                 static_cast<double>(with.most_behind), static_cast<double>(with.keyframes),
                 (with.cpu - without.cpu) / with.keyframes, 100 * with.share}));
  }
  std::vector<double> median;
  for (size_t column = 0; column < table.columns.size(); ++column) {
    std::vector<double> values;
    for (const Line& line : table.lines) values.push_back(line.values[column]);
    median.push_back(Summarise(values).median);
  }
  table.lines.push_back(line_of("median", std::move(median)));
  return table;
}

}  // namespace alidade::bench
