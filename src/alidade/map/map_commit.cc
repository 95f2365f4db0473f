// Changes of single objects of the map.
#include <algorithm>

#include "alidade/base/error.h"
#include "alidade/map/map_store.h"

namespace alidade {
namespace {

// Issues the next id. At 40 landmarks per frame and 30 frames/s the ids last 41 days.
template <typename IdType>
IdType Issue(uint32_t& next) {
  if (next == IdType::kNone) ThrowInput("the map has given all its ids (4294967295)");
  return {next++};
}

}  // namespace

MapCommit::MapCommit(const MapState& base, const ReleasedIds& released) : state_(base) {
  ++state_.version;
  std::erase_if(state_.forwards, [&](const Forward& f) { return f.version <= released.landmarks; });
  if (released.keyframes == 0) return;
  std::vector<KeyFrameId> forgotten;
  state_.culled.ForEach([&](const CulledKeyFrame& gone) {
    if (gone.version <= released.keyframes) forgotten.push_back(gone.id);
  });
  for (KeyFrameId id : forgotten) state_.culled.Erase(id.value, state_.version);
}

template <typename Object>
Object* MapCommit::EditIn(IdTable<Object>& table, uint32_t id) {
  const Object* object = table.At(id);
  if (object && object->version != state_.version) {
    auto copy = std::make_shared<Object>(*object);
    copy->version = state_.version;
    object = copy.get();
    table.Set(id, std::move(copy), state_.version);
  }
  return const_cast<Object*>(object);  // exclusive to this commit until it is published
}

KeyFrame* MapCommit::Edit(KeyFrameId id) { return EditIn(state_.keyframes, id.value); }

Landmark* MapCommit::Edit(LandmarkId id) { return EditIn(state_.landmarks, id.value); }

KeyFrameId MapCommit::Add(KeyFrame keyframe) {
  keyframe.landmarks.resize(keyframe.frame->keypoints.size());
  // The parent was chosen from a snapshot and may have been removed since.
  while (keyframe.parent.valid() && !Find(keyframe.parent)) {
    const CulledKeyFrame* gone = state_.culled.At(keyframe.parent.value);
    keyframe.parent = gone ? gone->parent : KeyFrameId{};
  }
  keyframe.map =
      keyframe.parent.valid() ? Find(keyframe.parent)->map : Issue<MapId>(state_.next_map);
  keyframe.id = Issue<KeyFrameId>(state_.next_keyframe);
  keyframe.version = state_.version;
  const KeyFrameId id = keyframe.id;
  state_.keyframes.Set(id.value, std::make_shared<KeyFrame>(std::move(keyframe)), state_.version);
  return id;
}

LandmarkId MapCommit::Add(Landmark landmark) {
  std::vector<Observation> observations;
  observations.swap(landmark.observations);
  landmark.id = Issue<LandmarkId>(state_.next_landmark);
  landmark.version = state_.version;
  const LandmarkId id = landmark.id;
  state_.landmarks.Set(id.value, std::make_shared<Landmark>(std::move(landmark)), state_.version);
  for (const Observation& seen : observations) AddObservation(id, seen.keyframe, seen.keypoint);
  return id;
}

bool MapCommit::AddObservation(LandmarkId landmark_id, KeyFrameId keyframe_id, int keypoint) {
  const Landmark* landmark = Find(landmark_id);
  const KeyFrame* keyframe = Find(keyframe_id);
  if (!landmark || !keyframe || keyframe->landmarks[keypoint].valid()) return false;
  const auto place =
      std::lower_bound(landmark->observations.begin(), landmark->observations.end(), keyframe_id,
                       [](const Observation& seen, KeyFrameId id) { return seen.keyframe < id; });
  if (place != landmark->observations.end() && place->keyframe == keyframe_id) return false;
  const auto offset = place - landmark->observations.begin();
  auto& observations = Edit(landmark_id)->observations;
  observations.insert(observations.begin() + offset, {keyframe_id, keypoint});
  Edit(keyframe_id)->landmarks[keypoint] = landmark_id;
  return true;
}

void MapCommit::RemoveObservation(LandmarkId landmark_id, KeyFrameId keyframe_id) {
  Landmark* landmark = Edit(landmark_id);
  if (!landmark) return;
  auto& observations = landmark->observations;
  const auto seen = std::find_if(observations.begin(), observations.end(),
                                 [&](const Observation& o) { return o.keyframe == keyframe_id; });
  if (seen == observations.end()) return;
  if (KeyFrame* keyframe = Edit(keyframe_id)) keyframe->landmarks[seen->keypoint] = {};
  observations.erase(seen);
  if (landmark->reference == keyframe_id && !observations.empty()) {
    landmark->reference = observations.front().keyframe;
  }
}

void MapCommit::Remove(LandmarkId id) {
  const Landmark* landmark = Find(id);
  if (!landmark) return;
  for (const Observation& seen : landmark->observations) {
    if (KeyFrame* keyframe = Edit(seen.keyframe)) keyframe->landmarks[seen.keypoint] = {};
  }
  state_.landmarks.Erase(id.value, state_.version);
}

void MapCommit::Replace(LandmarkId old, LandmarkId by) {
  if (old == by || !Find(old) || !Find(by)) return;
  if (Find(old)->scale_known && !Find(by)->scale_known && !Find(by)->depth_assumed)
    Edit(by)->scale_known = true;
  const std::vector<Observation> observations = Find(old)->observations;
  for (const Observation& seen : observations) {
    RemoveObservation(old, seen.keyframe);
    AddObservation(by, seen.keyframe, seen.keypoint);
  }
  state_.landmarks.Erase(old.value, state_.version);
  auto& forwards = state_.forwards;
  const auto place =
      std::lower_bound(forwards.begin(), forwards.end(), old,
                       [](const Forward& forward, LandmarkId id) { return forward.old < id; });
  forwards.insert(place, {old, by, state_.version});
}

void MapCommit::Remove(KeyFrameId id) {
  KeyFrame* keyframe = Edit(id);
  if (!keyframe || !keyframe->parent.valid()) return;  // the first keyframe defines the world frame
  const std::vector<LandmarkId> landmarks = keyframe->landmarks;
  for (LandmarkId landmark : landmarks) {
    if (landmark.valid()) RemoveObservation(landmark, id);
  }
  for (const Neighbour& neighbour : std::vector<Neighbour>(keyframe->covisible)) {
    if (KeyFrame* other = Edit(neighbour.id)) {
      std::erase_if(other->covisible, [&](const Neighbour& n) { return n.id == id; });
    }
  }
  std::vector<KeyFrameId> children;  // always younger than their parent
  state_.keyframes.ForEachFromLast([&](const KeyFrame& other) {
    if (other.parent == id) children.push_back(other.id);
    return other.id > id;
  });
  for (KeyFrameId child : children) Edit(child)->parent = keyframe->parent;
  for (KeyFrameId other_id : keyframe->loops) {
    if (KeyFrame* other = Edit(other_id)) std::erase(other->loops, id);
  }
  JoinMotions(*keyframe);
  const KeyFrame* parent = Find(keyframe->parent);
  auto left = std::make_shared<CulledKeyFrame>();
  left->id = id;
  left->parent = keyframe->parent;
  left->T_camera_parent = keyframe->T_camera_world * parent->T_camera_world.Inverse();
  left->T_camera_parent.t /= parent->scale;
  left->scale = keyframe->scale / parent->scale;
  left->version = state_.version;
  state_.culled.Set(id.value, std::move(left), state_.version);
  state_.keyframes.Erase(id.value, state_.version);
}

// The motion since `gone` becomes that since the keyframe before it.
void MapCommit::JoinMotions(const KeyFrame& gone) {
  KeyFrameId next;
  state_.keyframes.ForEachFromLast([&](const KeyFrame& other) {
    if (other.motion && other.motion->since == gone.id) next = other.id;
    return other.id > gone.id && !next.valid();
  });
  if (!next.valid()) return;
  KeyFrame* keyframe = Edit(next);
  if (!gone.motion) {
    keyframe->motion.reset();
    return;
  }
  auto joined = std::make_shared<KeyFrameMotion>(*keyframe->motion);
  joined->since = gone.motion->since;
  joined->motion = gone.motion->motion.Then(keyframe->motion->motion);
  keyframe->motion = std::move(joined);
}

void MapCommit::Remove(MapId id) {
  std::vector<LandmarkId> landmarks;
  state_.landmarks.ForEach([&](const Landmark& landmark) {
    if (Find(landmark.reference)->map == id) landmarks.push_back(landmark.id);
  });
  for (LandmarkId landmark : landmarks) state_.landmarks.Erase(landmark.value, state_.version);
  std::vector<KeyFrameId> keyframes;
  state_.keyframes.ForEach([&](const KeyFrame& keyframe) {
    if (keyframe.map == id) keyframes.push_back(keyframe.id);
  });
  // Collected first, because the map of a culled keyframe is found through its parent.
  std::vector<KeyFrameId> culled;
  state_.culled.ForEach([&](const CulledKeyFrame& gone) {
    if (state_.MapOf(gone.parent) == id) culled.push_back(gone.id);
  });
  for (KeyFrameId keyframe : keyframes) state_.keyframes.Erase(keyframe.value, state_.version);
  for (KeyFrameId keyframe : culled) state_.culled.Erase(keyframe.value, state_.version);
  ForgetWorld(id);
}

void MapCommit::ForgetWorld(MapId map) {
  std::erase_if(state_.worlds, [&](const MapWorld& world) { return world.map == map; });
}

void MapCommit::SetWorld(const MapWorld& world) {
  ForgetWorld(world.map);
  const auto after = std::find_if(state_.worlds.begin(), state_.worlds.end(),
                                  [&](const MapWorld& other) { return other.map > world.map; });
  state_.worlds.insert(after, world);
}

MapId MapCommit::Split(KeyFrameId first) {
  const KeyFrame* root = Find(first);
  if (!root || !root->parent.valid()) return root ? root->map : MapId{};
  const MapId older = root->map, younger = Issue<MapId>(state_.next_map);
  std::vector<KeyFrameId> leaving;
  state_.keyframes.ForEachFromLast([&](const KeyFrame& keyframe) {
    if (keyframe.map == older) leaving.push_back(keyframe.id);
    return keyframe.id > first;
  });
  for (KeyFrameId id : leaving) {
    KeyFrame* keyframe = Edit(id);
    keyframe->map = younger;
    if (keyframe->parent < first) keyframe->parent = id == first ? KeyFrameId{} : first;
  }
  const auto left = [&](KeyFrameId id) { return Find(id)->map == younger; };
  for (KeyFrameId id : leaving) {
    for (LandmarkId seen : std::vector<LandmarkId>(Find(id)->landmarks)) {
      const Landmark* landmark = seen.valid() ? Find(seen) : nullptr;
      if (!landmark) continue;
      const bool stays = !left(landmark->reference);
      bool divided = false;
      for (const Observation& at : std::vector<Observation>(landmark->observations)) {
        if (left(at.keyframe) != stays) continue;
        RemoveObservation(seen, at.keyframe);
        divided = true;
      }
      if (divided) RefreshLandmark(seen);
    }
    for (KeyFrameId other : std::vector<KeyFrameId>(Find(id)->loops)) {
      if (left(other)) continue;
      std::erase(Edit(id)->loops, other);
      std::erase(Edit(other)->loops, id);
    }
    RefreshCovisibility(id);
  }
  if (const MapWorld* world = FindWorld(state_.worlds, older)) {
    MapWorld same = *world;
    same.map = younger;
    SetWorld(same);
  }
  CountCorrection();
  return younger;
}

void MapCommit::AddLoop(KeyFrameId a, KeyFrameId b) {
  if (a == b || !Find(a) || !Find(b)) return;
  const auto enter = [&](KeyFrameId from, KeyFrameId to) {
    auto& loops = Edit(from)->loops;
    const auto place = std::lower_bound(loops.begin(), loops.end(), to);
    if (place == loops.end() || *place != to) loops.insert(place, to);
  };
  enter(a, b);
  enter(b, a);
}

}  // namespace alidade
