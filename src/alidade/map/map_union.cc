#include "alidade/map/map_union.h"

#include <algorithm>
#include <memory>

#include "alidade/base/error.h"

namespace alidade {
namespace {

template <typename IdType>
IdType Moved(IdType id, uint32_t by) {
  return id.valid() ? IdType{id.value + by} : id;
}

// End of the id range [first, first + count).
template <typename IdType>
uint32_t EndOf(uint32_t first, uint32_t count) {
  if (count >= IdType::kNone - first) ThrowInput("the maps have more objects than there are ids");
  return first + count;
}

std::shared_ptr<const Frame> Renumbered(const std::shared_ptr<const Frame>& frame, int by) {
  if (by == 0) return frame;
  auto copy = std::make_shared<Frame>(*frame);
  copy->number += by;
  return copy;
}

std::shared_ptr<KeyFrame> Moved(const KeyFrame& from, const UnitedPart& part) {
  auto keyframe = std::make_shared<KeyFrame>(from);
  keyframe->id = Moved(from.id, part.first_keyframe);
  keyframe->frame = Renumbered(from.frame, part.first_frame);
  keyframe->map = Moved(from.map, part.first_map);
  keyframe->parent = Moved(from.parent, part.first_keyframe);
  for (KeyFrameId& id : keyframe->loops) id = Moved(id, part.first_keyframe);
  for (LandmarkId& id : keyframe->landmarks) id = Moved(id, part.first_landmark);
  for (Neighbour& n : keyframe->covisible) n.id = Moved(n.id, part.first_keyframe);
  keyframe->version = 0;
  return keyframe;
}

std::shared_ptr<Landmark> Moved(const Landmark& from, const UnitedPart& part) {
  auto landmark = std::make_shared<Landmark>(from);
  landmark->id = Moved(from.id, part.first_landmark);
  for (Observation& seen : landmark->observations)
    seen.keyframe = Moved(seen.keyframe, part.first_keyframe);
  landmark->reference = Moved(from.reference, part.first_keyframe);
  landmark->born = Moved(from.born, part.first_keyframe);
  landmark->version = 0;
  return landmark;
}

}  // namespace

size_t MapUnion::PartOf(KeyFrameId id) const {
  const auto after = std::upper_bound(
      parts.begin(), parts.end(), id.value,
      [](uint32_t value, const UnitedPart& part) { return value < part.end_keyframe; });
  return static_cast<size_t>(after - parts.begin());
}

MapUnion Unite(std::span<const MapSnapshot> maps) {
  MapUnion all;
  auto state = std::make_shared<MapState>();
  int next_frame = 0;
  for (const MapSnapshot& map : maps) {
    UnitedPart part;
    part.first_keyframe = state->next_keyframe;
    part.first_landmark = state->next_landmark;
    part.first_map = state->next_map;
    part.first_frame = next_frame;
    state->next_keyframe = EndOf<KeyFrameId>(part.first_keyframe, map.next_keyframe());
    state->next_landmark = EndOf<LandmarkId>(part.first_landmark, map.next_landmark());
    state->next_map = EndOf<MapId>(part.first_map, map.state().next_map);
    part.end_keyframe = state->next_keyframe;
    part.end_map = state->next_map;
    map.keyframes().ForEach([&](const KeyFrame& keyframe) {
      auto moved = Moved(keyframe, part);
      next_frame = std::max(next_frame, moved->frame->number + 1);
      const uint32_t id = moved->id.value;
      state->keyframes.Set(id, std::move(moved), /*version=*/0);
    });
    map.landmarks().ForEach([&](const Landmark& landmark) {
      auto moved = Moved(landmark, part);
      const uint32_t id = moved->id.value;
      state->landmarks.Set(id, std::move(moved), /*version=*/0);
    });
    for (MapWorld world : map.state().worlds) {
      world.map = Moved(world.map, part.first_map);
      state->worlds.push_back(world);
    }
    all.parts.push_back(part);
  }
  all.map = MapSnapshot(std::move(state));
  return all;
}

}  // namespace alidade
