#include "alidade/tracking/local_map.h"

#include <algorithm>

#include "alidade/base/median.h"
#include "alidade/base/part_times.h"

namespace alidade {

namespace {
// Best covisible keyframes added for each keyframe that shares landmarks with the frame.
constexpr int kNeighboursEach = 10;
constexpr double kMaxTurn = 0.7;  // cosine of 45°, between the optical axes
// Largest distance, relative to the depth of the observed landmarks.
constexpr double kMaxMove = 0.5;
// Longest path since, relative to the same depth. After a longer path with drift, the loop closer
// must match the place first.
constexpr double kMaxWay = 10;

// Keyframes with a similar position and viewing direction, best first.
std::vector<KeyFrameId> LookingTheSameWay(const MapSnapshot& map, MapId within,
                                          const Se3& T_camera_world, double depth) {
  const Eigen::Vector3d centre = T_camera_world.Inverse().t,
                        axis = T_camera_world.R.row(2).transpose();
  std::vector<std::pair<double, KeyFrameId>> scored;
  Eigen::Vector3d after = centre;
  double way = 0;
  map.keyframes().ForEachFromLast([&](const KeyFrame& keyframe) {
    if (keyframe.map != within) return true;
    way += (keyframe.Centre() - after).norm();
    after = keyframe.Centre();
    const double turn = axis.dot(keyframe.T_camera_world.R.row(2).transpose());
    const double move = (keyframe.Centre() - centre).norm() / depth;
    if (turn > kMaxTurn && move < kMaxMove)
      scored.push_back({(1 - turn) / (1 - kMaxTurn) + move / kMaxMove, keyframe.id});
    return way < kMaxWay * depth;
  });
  std::sort(scored.begin(), scored.end());
  std::vector<KeyFrameId> ids;
  for (const auto& entry : scored) ids.push_back(entry.second);
  return ids;
}

}  // namespace

LocalMap LocalMapGatherer::Gather(const MapSnapshot& map, std::span<const LandmarkId> matches,
                                  const Se3& T_camera_world, int max_keyframes) {
  const PartTimer timer(FramePart::kLocalMap);
  landmarks_taken_.Clear();
  keyframes_taken_.Clear();
  votes_.Clear();
  std::vector<double> depths;
  for (LandmarkId id : matches) {
    const Landmark* landmark = id.valid() ? map.Find(id) : nullptr;
    if (!landmark) continue;
    for (const Observation& seen : landmark->observations) ++votes_[seen.keyframe];
    depths.push_back((T_camera_world * landmark->p_world).z());
  }

  LocalMap local;
  std::vector<Neighbour> sharing;
  for (const auto& [id, count] : votes_.entries()) sharing.push_back({id, count});
  std::sort(sharing.begin(), sharing.end(), [](const Neighbour& a, const Neighbour& b) {
    return a.shared != b.shared ? a.shared > b.shared : a.id < b.id;
  });
  if (sharing.empty()) return local;
  local.reference = sharing.front().id;

  const auto take = [&](KeyFrameId id) {
    if (static_cast<int>(local.keyframes.size()) >= max_keyframes) return false;
    if (!map.Find(id) || !keyframes_taken_.Enter(id)) return false;
    local.keyframes.push_back(id);
    return true;
  };
  for (const Neighbour& n : sharing) take(n.id);
  for (const KeyFrameId id :
       LookingTheSameWay(map, map.MapOf(local.reference), T_camera_world, UpperMedian(depths)))
    take(id);
  const size_t direct = local.keyframes.size();
  for (size_t i = 0; i < direct; ++i) {
    const auto& covisible = map.Find(local.keyframes[i])->covisible;
    for (size_t j = 0; j < covisible.size() && j < kNeighboursEach; ++j) {
      if (take(covisible[j].id)) break;
    }
    const KeyFrameId parent = map.Find(local.keyframes[i])->parent;
    if (parent.valid()) take(parent);
  }

  for (KeyFrameId id : local.keyframes) {
    for (LandmarkId landmark_id : map.Find(id)->landmarks) {
      if (!landmark_id.valid() || !landmarks_taken_.Enter(landmark_id)) continue;
      if (const Landmark* landmark = map.Find(landmark_id)) local.landmarks.push_back(landmark);
    }
  }
  return local;
}

}  // namespace alidade
