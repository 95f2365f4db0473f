#include "alidade/run/results/run_results.h"

#include <algorithm>

#include "alidade/base/print.h"

namespace alidade {
namespace {

std::vector<std::array<double, 2>> LostSpans(const std::vector<FramePose>& frames) {
  std::vector<std::array<double, 2>> spans;
  bool started = false;
  const FramePose* lost = nullptr;  // first frame of the current span
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

// Of that map instead of the newest.
void TellOf(const MapResults& map, const MapSnapshot& maps, InertialReport& inertial) {
  const MapWorld* world = maps.WorldOf(map.id);
  inertial.metric = map.meters;
  inertial.gravity = map.gravity;
  inertial.scale_sigma = world ? world->scale_sigma : 0;
  inertial.gravity_sigma = world ? world->down_sigma : 0;
}

}  // namespace

Se3 Mounted(const Se3& T_world_camera, const Eigen::Matrix3d& R_camera_rectified) {
  const Se3 turn{R_camera_rectified, Eigen::Vector3d::Zero()};
  return turn * T_world_camera * turn.Inverse();
}

RunResults ResultsOf(const Slam& slam, const RunLog& log,
                     const Eigen::Matrix3d& R_camera_rectified) {
  RunResults results;
  results.frames = slam.Trajectory();
  results.map = slam.Snapshot();
  results.times = slam.Times();
  results.counts = slam.Counts();
  results.semidense = slam.SemiDense();
  results.tracked = results.counts.let_go.tracked;
  results.lost_spans = LostSpans(results.frames);
  const Eigen::Matrix3d& turn = results.R_camera_rectified = R_camera_rectified;
  for (MapId id : results.map.Maps()) {
    results.maps.emplace_back();
    results.maps.back().id = id;
  }
  if (results.maps.empty()) results.maps.emplace_back();
  const auto in = [&](MapId id) -> MapResults& {
    return *std::find_if(results.maps.begin(), results.maps.end(),
                         [&](const MapResults& map) { return map.id == id; });
  };
  FrameStamps::Reader stamps(log.stamps);
  for (const FramePose& frame : results.frames) {
    if (!frame.tracked) continue;
    ++results.tracked;
    const auto& [stamp, number] = stamps.At(static_cast<size_t>(frame.index));
    if (!results.initialized_at) results.initialized_at = number;
    MapResults& map = in(frame.map);
    map.trajectory.push_back({frame.time, Mounted(frame.T_world_camera, turn), stamp});
    if (!frame.late)
      map.live.push_back({frame.time, Mounted(frame.T_world_camera_live, turn), stamp});
  }
  for (KeyFrameId id : results.map.KeyFrames()) {
    const KeyFrame* keyframe = results.map.Find(id);
    const int index = keyframe->frame->number - slam.first_number();
    MapResults& map = in(keyframe->map);
    map.keyframe_ids.push_back(id);
    map.keyframes.push_back(
        {keyframe->frame->time, Mounted(keyframe->T_camera_world.Inverse(), turn),
         index < 0 ? std::string() : stamps.At(static_cast<size_t>(index)).stamp});
  }
  std::stable_sort(results.maps.begin(), results.maps.end(),
                   [](const MapResults& a, const MapResults& b) {
                     return a.trajectory.size() > b.trajectory.size();
                   });
  for (MapResults& map : results.maps) {
    const MapWorld* world = results.map.WorldOf(map.id);
    if (!world) continue;
    map.meters = world->meters;
    if (world->KnowsDown()) map.gravity = turn * world->down;
  }
  results.inertial = slam.Inertial();
  TellOf(results.maps.front(), results.map, results.inertial);
  return results;
}

std::vector<std::vector<Se3>> PathOf(const RunResults& results, size_t number) {
  std::vector<std::vector<Se3>> path;
  const MapResults& map = results.maps[number];
  bool going_on = false;
  size_t next = 0;  // index in the trajectory
  for (const FramePose& frame : results.frames) {
    const bool here = frame.tracked && frame.map == map.id;
    if (here) {
      if (!going_on) path.emplace_back();
      path.back().push_back(map.trajectory[next++].T_world_camera);
    }
    going_on = here;
  }
  return path;
}

std::string LostInAll(const std::vector<std::array<double, 2>>& spans) {
  double seconds = 0;
  for (const auto& [from, to] : spans) seconds += to - from;
  const size_t times = spans.size();
  char text[64];
  PrintTo(text, sizeof(text), ", %.2f s in all", seconds);
  return (times == 1 ? "once" : times == 2 ? "twice" : std::to_string(times) + " times") + text;
}

double PathLength(const Trajectory& trajectory) {
  double length = 0;
  for (size_t i = 1; i < trajectory.size(); ++i) {
    length += (trajectory[i].T_world_camera.t - trajectory[i - 1].T_world_camera.t).norm();
  }
  return length;
}

}  // namespace alidade
