// The whole of a frame, as a live caller sees it: threaded, fed at the recording's own rate.
#include <chrono>
#include <thread>

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
  return section;
}

}  // namespace alidade::bench
