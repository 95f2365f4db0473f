#include "alidade/map/map_store.h"

#include <algorithm>

namespace alidade {
namespace {

bool OlderId(const Forward& forward, LandmarkId id) { return forward.old < id; }

}  // namespace

LandmarkId MapSnapshot::Current(LandmarkId id) const {
  const std::vector<Forward>& forwards = state_->forwards;
  while (id.valid() && !Find(id)) {
    const auto to = std::lower_bound(forwards.begin(), forwards.end(), id, OlderId);
    if (to == forwards.end() || to->old != id) return {};
    id = to->by;
  }
  return id;
}

double MapState::ScaleOf(KeyFrameId id) const {
  double scale = 1;
  const KeyFrame* keyframe = keyframes.At(id.value);
  while (!keyframe) {
    const CulledKeyFrame* gone = culled.At(id.value);
    if (!gone) return scale;
    scale *= gone->scale;
    id = gone->parent;
    keyframe = keyframes.At(id.value);
  }
  return scale * keyframe->scale;
}

MapId MapState::MapOf(KeyFrameId id) const {
  while (const CulledKeyFrame* gone = culled.At(id.value)) id = gone->parent;
  const KeyFrame* keyframe = keyframes.At(id.value);
  return keyframe ? keyframe->map : MapId{};
}

Se3 MapState::PoseOf(KeyFrameId id) const {
  std::vector<const CulledKeyFrame*> way;  // from `id` up to its first live ancestor
  while (const CulledKeyFrame* gone = culled.At(id.value)) {
    way.push_back(gone);
    id = gone->parent;
  }
  const KeyFrame* keyframe = keyframes.At(id.value);
  if (!keyframe) return {};
  Se3 T_camera_world = keyframe->T_camera_world;
  double scale = keyframe->scale;
  for (auto it = way.rbegin(); it != way.rend(); ++it) {
    Se3 T_camera_parent = (*it)->T_camera_parent;
    T_camera_parent.t *= scale;
    T_camera_world = T_camera_parent * T_camera_world;
    scale *= (*it)->scale;
  }
  return T_camera_world;
}

std::vector<MapId> MapSnapshot::Maps() const {
  std::vector<MapId> maps;
  keyframes().ForEach([&](const KeyFrame& keyframe) {
    // Each map has exactly one first keyframe.
    if (!keyframe.parent.valid()) maps.push_back(keyframe.map);
  });
  std::sort(maps.begin(), maps.end());
  return maps;
}

std::vector<KeyFrameId> MapSnapshot::KeyFramesOf(MapId map) const {
  std::vector<KeyFrameId> ids;
  keyframes().ForEach([&](const KeyFrame& keyframe) {
    if (keyframe.map == map) ids.push_back(keyframe.id);
  });
  return ids;
}

std::vector<KeyFrameId> MapSnapshot::KeyFrames() const {
  std::vector<KeyFrameId> ids;
  ids.reserve(static_cast<size_t>(keyframe_count()));
  keyframes().ForEach([&](const KeyFrame& keyframe) { ids.push_back(keyframe.id); });
  return ids;
}

std::vector<LandmarkId> MapSnapshot::Landmarks() const {
  std::vector<LandmarkId> ids;
  ids.reserve(static_cast<size_t>(landmark_count()));
  landmarks().ForEach([&](const Landmark& landmark) { ids.push_back(landmark.id); });
  return ids;
}

MapSnapshot MapStore::Publish(MapState&& state) {
  auto published = std::make_shared<const MapState>(std::move(state));
  std::lock_guard<std::mutex> lock(publish_mutex_);
  current_ = published;
  return MapSnapshot(std::move(published));
}

void MapStore::Restore(const MapSnapshot& saved) {
  std::lock_guard<std::mutex> writer(writer_mutex_);
  MapState state = saved.state();
  state.version = std::max(state.version, Snapshot().version()) + 1;
  Publish(std::move(state));
}

}  // namespace alidade
