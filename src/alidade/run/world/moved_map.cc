#include "alidade/run/world/moved_map.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>
#include <vector>

#include "alidade/io/files/trajectory_file.h"
#include "alidade/map/correction.h"
#include "alidade/run/world/trajectory_file_for.h"
#include "alidade/run/world/written_turn.h"

namespace alidade {

Se3 InNewWorld(const Se3& T_world_camera, const Sim3& T_new_world) {
  return {T_new_world.R * T_world_camera.R, T_new_world * T_world_camera.t};
}

Trajectory InNewWorld(Trajectory trajectory, const Sim3& T_new_world) {
  for (StampedPose& pose : trajectory)
    pose.T_world_camera = InNewWorld(pose.T_world_camera, T_new_world).Normalised();
  return trajectory;
}

MapWorld WorldOf(const SavedMap& saved, const MapPart& part) {
  if (part.keyframes.empty()) return {};
  const MapId map = saved.map.MapOf(part.keyframes.front());
  const MapWorld* world = saved.map.WorldOf(map);
  MapWorld known = world ? *world : MapWorld{};
  known.map = map;
  return known;
}

void MoveMap(SavedMap& saved, const MapPart& part, const Sim3& T_new_map, const MapWorld& known) {
  if (part.keyframes.empty()) return;
  std::vector<KeyFrameCorrection> moved;
  for (KeyFrameId id : part.keyframes) {
    const Se3 T = InNewWorld(saved.map.Find(id)->T_camera_world.Inverse(), T_new_map);
    moved.push_back({id, T.Inverse(), T_new_map.s});
  }
  MapWorld world = WorldOf(saved, part);
  if (world.KnowsDown()) world.down = (T_new_map.R * world.down).normalized();
  if (known.meters) {
    world.meters = true;
    world.scale_sigma = known.scale_sigma;
  }
  if (known.KnowsDown()) {
    world.down = known.down;
    world.down_sigma = known.down_sigma;
  }
  MapStore store;
  store.Restore(saved.map);
  saved.map = store.Commit([&](MapCommit& commit) {
    CommitCorrections(commit, moved);
    if (world.meters || world.KnowsDown()) commit.SetWorld(world);
  });
}

Eigen::Matrix3d WrittenTurnIn(const SavedMap& saved, const MapPart& part,
                              const std::string& folder) {
  const std::string file = TrajectoryFileFor(saved, part, folder);
  if (file.empty()) return Eigen::Matrix3d::Identity();
  Trajectory trajectory = ReadTrajectory(file);
  std::stable_sort(trajectory.begin(), trajectory.end(),
                   [](const StampedPose& a, const StampedPose& b) { return a.time < b.time; });
  return WrittenTurn(saved.map, KeyFramesIn(trajectory, saved, part));
}

Eigen::Matrix3d Upright(const Eigen::Vector3d& down, bool y_down) {
  const Eigen::Vector3d to = y_down ? Eigen::Vector3d(Eigen::Vector3d::UnitY())
                                    : Eigen::Vector3d(-Eigen::Vector3d::UnitZ());
  return Eigen::Quaterniond::FromTwoVectors(down, to).normalized().toRotationMatrix();
}

}  // namespace alidade
