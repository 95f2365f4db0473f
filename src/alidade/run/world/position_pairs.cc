#include "alidade/run/world/position_pairs.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <iterator>

namespace alidade {
namespace {

constexpr double kLongestStep = 0.5;  // seconds between poses that are interpolated

}  // namespace

std::optional<PositionPair> PathAt::At(double time) const {
  const auto after =
      std::lower_bound(trajectory_.begin(), trajectory_.end(), time,
                       [](const StampedPose& pose, double wanted) { return pose.time < wanted; });
  if (after == trajectory_.end()) return std::nullopt;
  const auto before = after == trajectory_.begin() ? after : std::prev(after);
  const auto next = before == after ? std::next(after) : after;
  if (next == trajectory_.end()) return std::nullopt;
  const double gap = next->time - before->time, share = (time - before->time) / gap;
  if (!(gap > 0) || gap > kLongestStep || share < 0) return std::nullopt;
  const Eigen::Vector3d way = next->T_world_camera.t - before->T_world_camera.t;
  PositionPair pair;
  pair.map = before->T_world_camera.t + share * way;
  pair.velocity = way / gap;
  pair.R = Eigen::Quaterniond(before->T_world_camera.R)
               .slerp(share, Eigen::Quaterniond(next->T_world_camera.R))
               .toRotationMatrix();
  pair.time = time;
  return pair;
}

PositionPairs PairsAt(const PathAt& path, const std::vector<TimedPosition>& positions,
                      double offset) {
  PositionPairs pairs;
  for (const TimedPosition& position : positions) {
    std::optional<PositionPair> pair = path.At(position.time - offset);
    if (!pair) continue;
    pair->measured = position.p;
    pairs.push_back(*pair);
  }
  return pairs;
}

}  // namespace alidade
