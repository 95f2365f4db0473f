#include "alidade/stream/told_map.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace alidade {
namespace {

bool Same(const Se3& a, const Se3& b) { return a.R == b.R && a.t == b.t; }

std::vector<KeyFrameId> EdgesOf(const KeyFrame& keyframe, int shared) {
  std::vector<KeyFrameId> edges;
  for (const Neighbour& neighbour : keyframe.covisible) {  // sorted by shared landmarks, descending
    if (neighbour.shared < shared) break;
    edges.push_back(neighbour.id);
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

template <typename Id>
void SortUnique(std::vector<Id>& ids) {
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
}

}  // namespace

// Pose of a culled keyframe relative to the keyframe that replaces it. The map keeps it while
// frames refer to it (MapState::culled); afterwards it follows from what was sent last.
ToldCull ToldMap::CullOf(KeyFrameId id, const MapSnapshot& map) const {
  ToldCull cull{id, id, 1, {}};  // T_follows_culled is composed step by step
  while (!map.Find(cull.follows)) {
    Se3 T_parent_gone;
    double scale = 1;  // of the removed keyframe, relative to its parent's scale
    KeyFrameId parent;
    if (const CulledKeyFrame* gone = map.state().culled.At(cull.follows.value)) {
      parent = gone->parent;
      scale = gone->scale;
      T_parent_gone = gone->T_camera_parent.Inverse();
    } else {
      const auto told = keyframes_.find(cull.follows.value);
      if (told == keyframes_.end()) return {id, {}, 1, {}};
      parent = told->second.parent;
      const auto before = keyframes_.find(parent.value);
      if (before == keyframes_.end()) return {id, {}, 1, {}};
      scale = told->second.scale / before->second.scale;
      T_parent_gone = before->second.T_world_camera.Inverse() * told->second.T_world_camera;
      T_parent_gone.t /= before->second.scale;
    }
    // p_parent = T_parent_gone * (scale * p_gone) = T_parent_gone * (scale * T_gone_id * …).
    cull.T_follows_culled.t *= scale;
    cull.T_follows_culled = T_parent_gone * cull.T_follows_culled;
    cull.scale *= scale;
    cull.follows = parent;
  }
  return cull;
}

void ToldMap::UpdateKeyFrame(const KeyFrame& keyframe, MapNews& news) {
  const auto [place, is_new] = keyframes_.try_emplace(keyframe.id.value);
  ToldKeyFrame& told = place->second;
  const Se3 T_world_camera = keyframe.T_camera_world.Inverse();
  std::vector<KeyFrameId> covisible = EdgesOf(keyframe, settings_.edge_shared);
  const bool moved = !Same(told.T_world_camera, T_world_camera) || told.scale != keyframe.scale;
  if (is_new || told.map != keyframe.map || told.parent != keyframe.parent ||
      told.covisible != covisible || told.loops != keyframe.loops) {
    news.keyframes.push_back(keyframe.id);
  } else if (moved) {
    news.moved.push_back(keyframe.id);
  }
  if (is_new && !keyframe.parent.valid()) news.begun.push_back(keyframe.map);
  if (!is_new && told.map != keyframe.map) news.merged.push_back({told.map, keyframe.map});
  for (KeyFrameId other : keyframe.loops) {
    if (other < keyframe.id && !std::binary_search(told.loops.begin(), told.loops.end(), other)) {
      news.loops.push_back({other, keyframe.id});
    }
  }
  if (told.depth != keyframe.depth) news.depths.push_back(keyframe.id);
  told = {keyframe.map,         keyframe.parent, keyframe.frame->number,
          keyframe.frame->time, T_world_camera,  keyframe.scale,
          std::move(covisible), keyframe.loops,  keyframe.depth};
}

void ToldMap::UpdateLandmark(const Landmark& landmark, MapNews& news) {
  const ToldKeyFrame& reference = keyframes_.at(landmark.reference.value);
  const Se3& T_world_camera = reference.T_world_camera;
  const Eigen::Vector3d p =
      T_world_camera.R.transpose() * (landmark.p_world - T_world_camera.t) / reference.scale;
  const auto [place, is_new] = landmarks_.try_emplace(landmark.id.value);
  ToldLandmark& told = place->second;
  if (!is_new && told.keyframe == landmark.reference &&
      (p - told.p.cast<double>()).norm() <= settings_.landmark_tolerance * p.norm()) {
    return;
  }
  told = {landmark.reference, p.cast<float>()};
  news.landmarks.push_back(landmark.id);
}

MapNews ToldMap::Update(const MapSnapshot& map) {
  MapNews news;
  std::vector<KeyFrameId> gone;
  std::vector<const KeyFrame*> changed;
  map.keyframes().ForEachChange(snapshot_.keyframes(),
                                [&](const KeyFrame* before, const KeyFrame* now) {
                                  if (now) {
                                    changed.push_back(now);
                                  } else {
                                    gone.push_back(before->id);
                                  }
                                });
  // First, because it uses the poses that were sent last.
  for (KeyFrameId id : gone) news.culled.push_back(CullOf(id, map));
  for (const KeyFrame* keyframe : changed) UpdateKeyFrame(*keyframe, news);

  map.landmarks().ForEachChange(snapshot_.landmarks(),
                                [&](const Landmark* before, const Landmark* now) {
                                  if (now) {
                                    UpdateLandmark(*now, news);
                                  } else {
                                    landmarks_.erase(before->id.value);
                                    news.removed_landmarks.push_back(before->id);
                                  }
                                });
  // A landmark that kept its position while its keyframe moved has changed relative to the
  // keyframe.
  const auto check = [&](const std::vector<KeyFrameId>& ids) {
    for (KeyFrameId id : ids) {
      for (LandmarkId seen : map.Find(id)->landmarks) {
        const Landmark* landmark = seen.valid() ? map.Find(seen) : nullptr;
        if (landmark && landmark->reference == id) UpdateLandmark(*landmark, news);
      }
    }
  };
  check(news.keyframes);
  check(news.moved);
  SortUnique(news.landmarks);
  SortUnique(news.loops);
  SortUnique(news.merged);

  for (const ToldCull& cull : news.culled) {
    if (!cull.follows.valid()) news.given_up.push_back(keyframes_.at(cull.id.value).map);
  }
  SortUnique(news.given_up);
  for (KeyFrameId id : gone) keyframes_.erase(id.value);
  news.worlds = map.state().worlds != snapshot_.state().worlds;
  snapshot_ = map;
  return news;
}

}  // namespace alidade
