#include "run_results.h"

namespace alidade {
namespace {

// From the rectified camera's world to the mounted camera's.
Se3 Mounted(const Se3& T_world_camera, const Eigen::Matrix3d& R_camera_rectified) {
  const Se3 turn{R_camera_rectified, Eigen::Vector3d::Zero()};
  return turn * T_world_camera * turn.Inverse();
}

std::vector<std::array<double, 2>> LostSpans(const std::vector<FramePose>& frames) {
  std::vector<std::array<double, 2>> spans;
  bool started = false;
  const FramePose* lost = nullptr;  // first frame of the span that is open
  for (const FramePose& frame : frames) {
    if (frame.tracked) {
      if (lost) spans.push_back({lost->time, frame.time});
      lost = nullptr;
      started = true;
    } else if (started && !lost) {
      lost = &frame;
    }
  }
  if (lost) spans.push_back({lost->time, frames.back().time});
  return spans;
}

}  // namespace

RunResults ResultsOf(const Slam& slam, const RunRecord& record) {
  RunResults results;
  results.frames = slam.Trajectory();
  results.map = slam.Snapshot();
  results.times = slam.Times();
  results.relocalisations = slam.relocalisations();
  results.lost_spans = LostSpans(results.frames);
  const Eigen::Matrix3d& turn = results.R_camera_rectified = record.source.R_camera_rectified;
  for (const FramePose& frame : results.frames) {
    if (!frame.tracked) continue;
    const auto index = static_cast<size_t>(frame.index);
    if (!results.initialised_at) results.initialised_at = record.numbers[index];
    const std::string& stamp = record.stamps[index];
    results.trajectory.push_back({frame.time, Mounted(frame.T_world_camera, turn), stamp});
    results.live.push_back({frame.time, Mounted(frame.T_world_camera_live, turn), stamp});
  }
  for (KeyFrameId id : results.map.KeyFrames()) {
    const KeyFrame* keyframe = results.map.Find(id);
    results.keyframes.push_back({keyframe->frame->time,
                                 Mounted(keyframe->T_camera_world.Inverse(), turn),
                                 record.stamps[static_cast<size_t>(keyframe->frame->number)]});
  }
  return results;
}

double PathLength(const Trajectory& trajectory) {
  double length = 0;
  for (size_t i = 1; i < trajectory.size(); ++i) {
    length += (trajectory[i].T_world_camera.t - trajectory[i - 1].T_world_camera.t).norm();
  }
  return length;
}

}  // namespace alidade
