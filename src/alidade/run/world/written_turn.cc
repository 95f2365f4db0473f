#include "alidade/run/world/written_turn.h"

#include <algorithm>

#include "alidade/geometry/alignment.h"

namespace alidade {
namespace {

constexpr double kSamePlace = 1e-6;  // map units: poses are written with 9 digits
// map units: smallest distance of keyframes that determines a direction
constexpr double kTold = 1e-2;

}  // namespace

std::vector<KnownPose> KeyFramesIn(const Trajectory& trajectory, const SavedMap& saved,
                                   const MapPart& part) {
  constexpr double kSameStamp = 1e-6;  // seconds
  std::vector<KnownPose> known;
  for (KeyFrameId id : part.keyframes) {
    const double time = saved.map.Find(id)->frame->time;
    const auto at =
        std::lower_bound(trajectory.begin(), trajectory.end(), time - kSameStamp,
                         [](const StampedPose& pose, double wanted) { return pose.time < wanted; });
    if (at != trajectory.end() && at->time <= time + kSameStamp) known.push_back({*at, id});
  }
  std::sort(known.begin(), known.end(),
            [](const KnownPose& a, const KnownPose& b) { return a.first.time < b.first.time; });
  return known;
}

Eigen::Matrix3d WrittenTurn(const MapSnapshot& map, const std::vector<KnownPose>& known) {
  std::vector<Eigen::Vector3d> written{Eigen::Vector3d::Zero()}, mapped{Eigen::Vector3d::Zero()};
  bool same = true;
  for (const auto& [pose, id] : known) {
    const Se3 T = map.Find(id)->T_camera_world.Inverse();
    same = same && (pose.T_world_camera.t - T.t).norm() < kSamePlace * (1 + T.t.norm()) &&
           (pose.T_world_camera.R - T.R).norm() < kSamePlace;
    if (T.t.norm() < kTold) continue;
    written.push_back(pose.T_world_camera.t);
    mapped.push_back(T.t);
    // Rotations also determine R, by their axes: R_written = R R_map Rᵀ.
    const auto axis = [](const Eigen::Matrix3d& R) {
      return Eigen::Vector3d(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
    };
    written.push_back(axis(pose.T_world_camera.R));
    mapped.push_back(axis(T.R));
  }
  if (same || written.size() < 3) return Eigen::Matrix3d::Identity();
  return AlignPoints(written, mapped, /*with_scale=*/false).R;
}

}  // namespace alidade
