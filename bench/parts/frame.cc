// The whole of a frame, as a live caller sees it: threaded, fed at the recording's own rate. And
// its parts, in one thread.
#include <array>
#include <chrono>
#include <thread>

#include "alidade/base/parallel.h"
#include "alidade/base/part_times.h"
#include "alidade/base/timing.h"
#include "alidade/slam.h"
#include "bench/measure/reference.h"
#include "bench/parts/parts.h"

namespace alidade::bench {
namespace {

struct Run {
  std::vector<double> frame;  // milliseconds Track() took, of the frames that were tracked
  double cpu = 0;             // milliseconds of all threads, per frame
  int tracked = 0;
};

Run Play(const Recording& recording, const SlamSettings& settings, Reference& reference,
         std::vector<double>& u) {
  Slam slam(recording.info.camera, settings);
  Run run;
  double reference_cpu = 0;
  const double cpu_start = ProcessCpuSeconds();
  const Stopwatch clock;
  for (const SourceFrame& frame : recording.frames) {
    const double due = settings.threaded ? frame.time - recording.frames[0].time : 0;
    const double ahead = due - clock.Milliseconds() * 1e-3;
    if (ahead > 0) std::this_thread::sleep_for(std::chrono::duration<double>(ahead));
    // The reference has the turn before each frame: the mapper of the frame before is mostly done
    // by then.
    u.push_back(reference.Run(frame.image));
    reference_cpu += u.back();
    const Stopwatch watch;
    const TrackResult result = slam.Track({frame.time, frame.image, frame.right, frame.depth});
    if (result.state != TrackState::kTracking) continue;
    run.frame.push_back(watch.Milliseconds());
    ++run.tracked;
  }
  slam.Finish();
  run.cpu = ((ProcessCpuSeconds() - cpu_start) * 1e3 - reference_cpu) /
            static_cast<double>(recording.frames.size());
  return run;
}

// What the driving thread does in a frame that is tracked, part by part, without the work of other
// threads.
Table PartsOf(const Recording& recording, Sensor sensor, const std::string& profile,
              Reference& reference, std::vector<double>& u) {
  SlamSettings settings;
  settings.sensor = sensor;
  settings.ApplyProfile(profile);
  SetThreadCount(1);
  Slam slam(recording.info.camera, settings);
  std::array<std::vector<double>, kFrameParts> parts;
  std::vector<double> whole;
  for (const SourceFrame& frame : recording.frames) {
    u.push_back(reference.Run(frame.image));
    PartTimes times;
    const TrackResult result =
        slam.Track({frame.time, frame.image, frame.right, frame.depth, {}, frame.imu});
    const std::array<double, kFrameParts> taken = times.Take();
    if (result.state != TrackState::kTracking) continue;
    double sum = 0;
    for (int i = 0; i < kFrameParts; ++i) {
      if (i == static_cast<int>(FramePart::kMapping)) continue;
      parts[i].push_back(taken[i]);
      sum += taken[i];
    }
    whole.push_back(sum);
  }
  SetThreadCount(0);
  Table table;
  table.name = std::string("parts of a frame, ") + NameOf(sensor) + ", " + profile;
  table.columns = {{"mean", "ms"}, {"share", "%"}, {"median", "ms"}, {"p95", "ms"}};
  const double mean = Summarise(whole).mean;
  const auto add = [&](const char* name, const std::vector<double>& samples) {
    const Summary s = Summarise(samples);
    Line line;
    line.of.name = name;
    line.of.sensor = NameOf(sensor);
    line.of.profile = profile;
    line.of.source = recording.source;
    line.of.frames = static_cast<int>(recording.frames.size());
    line.values = {s.mean, 100 * s.mean / mean, s.median, s.p95};
    table.lines.push_back(std::move(line));
  };
  for (int i = 0; i < kFrameParts; ++i) {
    if (Summarise(parts[i]).mean > 0) add(NameOf(static_cast<FramePart>(i)), parts[i]);
  }
  add("all", whole);
  table.note = "One thread, inline; " + std::to_string(whole.size()) +
               " tracked frames; mapping and loops are not in it";
  return table;
}

}  // namespace

Section BenchFrame(const Recording& recording) {
  Section section;
  section.name = "frame";
  Reference reference;
  const auto add = [&](Sensor sensor, const std::string& profile, bool threaded) {
    SlamSettings settings;
    settings.sensor = sensor;
    settings.threaded = threaded;
    settings.ApplyProfile(profile);
    const Run run = Play(recording, settings, reference, section.u_milliseconds);
    const std::string tracked = std::to_string(run.tracked) + " of " +
                                std::to_string(recording.frames.size()) + " frames tracked";
    const std::string schedule = threaded ? "threaded" : "inline";
    for (Timing timing :
         {TimingOf(schedule + ", Track()", recording, run.frame, tracked),
          TimingOf(schedule + ", CPU of all threads", recording, {run.cpu}, "mean per frame")}) {
      timing.of.sensor = NameOf(sensor);
      timing.of.profile = profile;
      section.timings.push_back(std::move(timing));
    }
  };
  if (recording.info.sensor == Sensor::kRgbd) add(Sensor::kRgbd, "desktop", true);
  if (recording.info.sensor == Sensor::kStereo) add(Sensor::kStereo, "desktop", true);
  add(Sensor::kMono, "desktop", true);
  add(Sensor::kMono, "phone", true);
  add(Sensor::kMono, "desktop", false);

  const auto add_parts = [&](Sensor sensor, const std::string& profile) {
    section.tables.push_back(
        PartsOf(recording, sensor, profile, reference, section.u_milliseconds));
  };
  if (recording.info.sensor != Sensor::kMono) add_parts(recording.info.sensor, "desktop");
  add_parts(Sensor::kMono, "desktop");
  add_parts(Sensor::kMono, "phone");
  return section;
}

}  // namespace alidade::bench
