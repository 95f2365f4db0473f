#include "bench/dynamic/run.h"

#include "alidade/base/error.h"
#include "alidade/run/results/run_results.h"
#include "alidade/run/sources/frame_input.h"

namespace alidade::bench {
DynamicErrors EvaluateErrors(const DynamicScene& scene, Sensor sensor, const Trajectory& estimate) {
  DynamicErrors errors;
  const Alignment align = sensor == Sensor::kMono ? Alignment::kSim3 : Alignment::kSe3;
  AteSettings ate;
  ate.align = align;
  ate.source_span = scene.span();
  RpeSettings rpe;
  rpe.align = align;
  rpe.source_span = scene.span();
  try {
    errors.ate = EvaluateAte(scene.truth, estimate, ate).error;
    rpe.pairs = PairSelection::kEvery;
    const RpeResult every = EvaluateRpe(scene.truth, estimate, rpe);
    errors.every_trans = every.trans;
    errors.every_rot = every.rot;
    rpe.pairs = PairSelection::kAll;
    const RpeResult second = EvaluateRpe(scene.truth, estimate, rpe);
    errors.second_trans = second.trans;
    errors.second_rot = second.rot;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kInput) throw;  // too short a trajectory: nothing to tell
  }
  return errors;
}

DynamicRun RunDynamic(const DynamicScene& scene, const SlamSettings& settings,
                      const std::shared_ptr<Detector>& detector,
                      const std::vector<std::vector<cv::Rect>>& detected,
                      const FrameVisitor& visit) {
  const bool full = settings.dynamics.mode == DynamicsMode::kFull;
  Slam slam(scene.info.camera, settings, full ? detector : nullptr);
  RunLog log;
  DynamicRun run;
  for (size_t i = 0; i < scene.frames.size(); ++i) {
    const SourceFrame& frame = scene.frames[i];
    slam.Track(InputOf(frame));
    log.stamps.Add({frame.stamp, frame.number});
    if (scene.has_masks()) {
      const std::vector<cv::Rect> none;
      AddFrame(scene.masks[i], detected.empty() ? none : detected[i], scene.people[i],
               slam.MoverMask(), slam.Features(), slam.camera().width, run.masks);
    }
    if (visit) visit(i, slam);
  }
  slam.Finish();
  const RunResults results = ResultsOf(slam, log, scene.info.R_camera_rectified);
  if (scene.has_masks()) AddMap(results.map, slam.camera(), scene.masks, run.masks);
  run.trajectory = results.maps.front().trajectory;
  run.errors = EvaluateErrors(scene, settings.sensor, run.trajectory);
  run.frames = static_cast<int>(scene.frames.size());
  run.tracked = results.tracked;
  run.start = results.initialized_at.value_or(-1);
  run.lost = static_cast<int>(results.lost_spans.size());
  run.maps = static_cast<int>(results.map.Maps().size());
  run.times = results.times;
  return run;
}

}  // namespace alidade::bench
