#include "alidade/stream/stream_frame.h"

#include <utility>

namespace alidade {
namespace {

// Processing time of each stage since `before`; -1 for a stage that did not run.
StreamMilliseconds MillisecondsSince(const LatestTimes& before, const LatestTimes& now) {
  const auto of = [](const SampleLog::Reading& then, const SampleLog::Reading& last) {
    return last.number > then.number ? static_cast<float>(last.value) : -1.f;
  };
  return {of(before.frame, now.frame),   of(before.extract, now.extract),
          of(before.track, now.track),   of(before.map, now.map),
          of(before.loop, now.loop),     of(before.semidense, now.semidense),
          of(before.detect, now.detect), of(before.dynamics, now.dynamics)};
}

}  // namespace

StreamFrame FrameAsLeft(const Slam& slam, int number, double time, const TrackResult& result,
                        LatestTimes& latest) {
  StreamFrame told;
  told.number = number;
  told.time = time;
  told.result = result;
  const std::vector<FramePose> last = slam.Trajectory(slam.frames() - 1);
  if (!last.empty()) told.pose = last.back();
  const LatestTimes before = std::exchange(latest, slam.Latest());
  told.ms = MillisecondsSince(before, latest);
  told.features = slam.Features();
  told.mover_mask = slam.MoverMask();
  told.map = slam.Snapshot();
  told.camera = slam.camera();
  if (const auto seen = slam.Detections()) {
    told.detection_age = seen->seconds_ago;
    for (size_t i = 0; i < seen->detections.size(); ++i)
      told.detections.push_back(
          {seen->detections[i].box, seen->detections[i].score, seen->names[i]});
  }
  return told;
}

}  // namespace alidade
