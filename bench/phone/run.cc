#include <chrono>
#include <thread>

#include "alidade/base/error.h"
#include "alidade/base/parallel.h"
#include "alidade/base/timing.h"
#include "alidade/run/calibration/unknown_camera.h"
#include "alidade/run/results/run_results.h"
#include "alidade/run/sources/any_source.h"
#include "alidade/run/sources/truth.h"
#include "alidade/slam.h"
#include "bench/phone/phone.h"

namespace alidade::bench {

PhoneRecording LoadPhoneRecording(const std::string& source, int count) {
  SourceOptions options;
  options.sensor = Sensor::kMono;
  options.last = count - 1;
  const auto opened = OpenAnySource(source, options);
  PhoneRecording loaded{{source, opened->Info(), {}}, {}};
  while (auto frame = opened->Next()) {
    if (!frame->problem.empty()) continue;
    if (frame->T_world_camera)
      loaded.truth.push_back({frame->time, *frame->T_world_camera, frame->stamp});
    frame->true_depth.release();
    loaded.recording.frames.push_back(std::move(*frame));
  }
  if (loaded.recording.frames.size() < 2)
    ThrowInput("phone: " + source + " has fewer than 2 frames that can be read");
  if (loaded.truth.empty()) loaded.truth = TruthBeside(source);
  SourceInfo& info = loaded.recording.info;
  if (info.camera_guessed) {
    SlamSettings settings;
    settings.ApplyProfile("phone");
    const CameraFound found = FindCamera([&] { return OpenAnySource(source, options); }, settings,
                                         {}, [](const auto&) { return true; });
    if (found.usable) info.camera = found.estimate.camera;
  }
  return loaded;
}

PhoneRun RunNative(const PhoneRecording& from, const PhoneVariant& variant) {
  const Recording& recording = from.recording;
  SetThreadCount(variant.threads);
  RunLog log;
  Slam slam(recording.info.camera, variant.settings);
  const double cpu_start = ProcessCpuSeconds();
  const Stopwatch clock;
  for (const SourceFrame& frame : recording.frames) {
    log.stamps.Add({frame.stamp, frame.number});
    ++log.frames;
    const double due = variant.settings.threaded ? frame.time - recording.frames.front().time : 0;
    const double ahead = due - clock.Milliseconds() * 1e-3;
    if (ahead > 0) std::this_thread::sleep_for(std::chrono::duration<double>(ahead));
    slam.Track({frame.time, frame.image, {}, {}});
  }
  const double cpu = (ProcessCpuSeconds() - cpu_start) * 1e3 / log.frames;
  slam.Finish();
  const RunResults results = ResultsOf(slam, log, recording.info.R_camera_rectified);
  return {results.times.frame,
          results.times.extract,
          results.times.track,
          results.times.map,
          results.maps.front().trajectory,
          results.map.keyframe_count(),
          cpu};
}

}  // namespace alidade::bench
