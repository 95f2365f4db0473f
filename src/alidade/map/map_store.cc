#include "alidade/map/map_store.h"

#include <algorithm>
#include <limits>

namespace alidade {
namespace {

constexpr int kMinShared =
    15;  // landmarks two keyframes must share to count as covisible (ORB-SLAM §III-D)

bool MoreShared(const Neighbour& a, const Neighbour& b) {
  return a.shared != b.shared ? a.shared > b.shared : a.id < b.id;
}

template <typename IdType, typename Object>
std::vector<IdType> Alive(const MapTable<Object>& table, bool (*is_alive)(const Object&)) {
  std::vector<IdType> ids;
  ids.reserve(table.alive);
  for (uint32_t i = 0; i < table.next; ++i) {
    const Object* object = table.At(i);
    if (object && is_alive(*object)) ids.push_back({i});
  }
  return ids;
}

}  // namespace

LandmarkId MapSnapshot::Current(LandmarkId id) const {
  while (id.valid()) {
    const Landmark* landmark = state_->landmarks.At(id.value);
    if (!landmark) return {};
    if (!landmark->replaced_by.valid()) return id;
    id = landmark->replaced_by;
  }
  return {};
}

double MapState::ScaleOf(KeyFrameId id) const {
  double scale = 1;
  const KeyFrame* keyframe = keyframes.At(id.value);
  while (keyframe) {
    scale *= keyframe->scale;
    if (!keyframe->culled()) break;
    keyframe = keyframes.At(keyframe->parent.value);
  }
  return scale;
}

MapId MapState::MapOf(KeyFrameId id) const {
  const KeyFrame* keyframe = keyframes.At(id.value);
  while (keyframe && keyframe->culled()) keyframe = keyframes.At(keyframe->parent.value);
  return keyframe ? keyframe->map : MapId{};
}

Se3 MapState::PoseOf(KeyFrameId id) const {
  std::vector<const KeyFrame*> culled;  // from `id` up to the first that lives
  const KeyFrame* keyframe = keyframes.At(id.value);
  while (keyframe && keyframe->culled()) {
    culled.push_back(keyframe);
    keyframe = keyframes.At(keyframe->parent.value);
  }
  if (!keyframe) return {};
  Se3 T_camera_world = keyframe->T_camera_world;
  double scale = keyframe->scale;
  for (auto it = culled.rbegin(); it != culled.rend(); ++it) {
    Se3 T_camera_parent = (*it)->T_camera_parent;
    T_camera_parent.t *= scale;
    T_camera_world = T_camera_parent * T_camera_world;
    scale *= (*it)->scale;
  }
  return T_camera_world;
}

std::vector<MapId> MapSnapshot::Maps() const {
  std::vector<uint8_t> seen(state_->next_map, 0);
  for (KeyFrameId id : KeyFrames()) seen[Find(id)->map.value] = 1;
  std::vector<MapId> maps;
  for (uint32_t i = 0; i < seen.size(); ++i) {
    if (seen[i]) maps.push_back({i});
  }
  return maps;
}

std::vector<KeyFrameId> MapSnapshot::KeyFramesOf(MapId map) const {
  std::vector<KeyFrameId> ids = KeyFrames();
  std::erase_if(ids, [&](KeyFrameId id) { return Find(id)->map != map; });
  return ids;
}

std::vector<KeyFrameId> MapSnapshot::KeyFrames() const {
  return Alive<KeyFrameId, KeyFrame>(state_->keyframes,
                                     [](const KeyFrame& k) { return !k.culled(); });
}

std::vector<LandmarkId> MapSnapshot::Landmarks() const {
  return Alive<LandmarkId, Landmark>(state_->landmarks,
                                     [](const Landmark& l) { return !l.replaced_by.valid(); });
}

template <typename Object>
MapPage<Object>& MapCommit::EditPage(MapTable<Object>& table, uint32_t index) {
  auto& page = table.pages[index / MapPage<Object>::kSize];
  if (page->version != state_.version) {
    auto copy = std::make_shared<MapPage<Object>>(*page);
    copy->version = state_.version;
    page = std::move(copy);
  }
  return const_cast<MapPage<Object>&>(*page);  // ours alone until published
}

template <typename Object>
void MapCommit::SetSlot(MapTable<Object>& table, uint32_t index,
                        std::shared_ptr<const Object> object) {
  EditPage(table, index).slots[index % MapPage<Object>::kSize] = std::move(object);
}

template <typename Object>
Object* MapCommit::EditObject(MapTable<Object>& table, uint32_t index) {
  const Object* object = table.At(index);
  if (object->version != state_.version) {
    auto copy = std::make_shared<Object>(*object);
    copy->version = state_.version;
    object = copy.get();
    SetSlot<Object>(table, index, std::move(copy));
  }
  return const_cast<Object*>(object);  // ours alone until published
}

template <typename Object>
uint32_t MapCommit::Append(MapTable<Object>& table, Object object) {
  const uint32_t index = table.next++;
  if (index / MapPage<Object>::kSize == table.pages.size()) {
    auto page = std::make_shared<MapPage<Object>>();
    page->version = state_.version;
    table.pages.push_back(std::move(page));
  }
  object.id = {index};
  object.version = state_.version;
  SetSlot<Object>(table, index, std::make_shared<Object>(std::move(object)));
  ++table.alive;
  return index;
}

const KeyFrame* MapCommit::Find(KeyFrameId id) const {
  const KeyFrame* keyframe = state_.keyframes.At(id.value);
  return keyframe && !keyframe->culled() ? keyframe : nullptr;
}

const Landmark* MapCommit::Find(LandmarkId id) const {
  const Landmark* landmark = state_.landmarks.At(id.value);
  return landmark && !landmark->replaced_by.valid() ? landmark : nullptr;
}

KeyFrame* MapCommit::Edit(KeyFrameId id) {
  return Find(id) ? EditObject(state_.keyframes, id.value) : nullptr;
}

Landmark* MapCommit::Edit(LandmarkId id) {
  return Find(id) ? EditObject(state_.landmarks, id.value) : nullptr;
}

KeyFrameId MapCommit::Add(KeyFrame keyframe) {
  keyframe.landmarks.resize(keyframe.frame->keypoints.size());
  // The parent was chosen on a snapshot, and may have been removed since.
  while (keyframe.parent.valid() && !Find(keyframe.parent)) {
    const KeyFrame* gone = state_.keyframes.At(keyframe.parent.value);
    keyframe.parent = gone ? gone->parent : KeyFrameId{};
  }
  keyframe.map = keyframe.parent.valid() ? Find(keyframe.parent)->map : MapId{state_.next_map++};
  return {Append(state_.keyframes, std::move(keyframe))};
}

LandmarkId MapCommit::Add(Landmark landmark) {
  std::vector<Observation> observations;
  observations.swap(landmark.observations);
  const LandmarkId id{Append(state_.landmarks, std::move(landmark))};
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
  SetSlot<Landmark>(state_.landmarks, id.value, nullptr);
  --state_.landmarks.alive;
}

void MapCommit::Replace(LandmarkId old, LandmarkId by) {
  if (old == by || !Find(old) || !Find(by)) return;
  const std::vector<Observation> observations = Find(old)->observations;
  for (const Observation& seen : observations) {
    RemoveObservation(old, seen.keyframe);
    AddObservation(by, seen.keyframe, seen.keypoint);
  }
  Landmark forward;
  forward.id = old;
  forward.replaced_by = by;
  forward.version = state_.version;
  SetSlot<Landmark>(state_.landmarks, old.value, std::make_shared<Landmark>(std::move(forward)));
  --state_.landmarks.alive;
}

void MapCommit::Remove(KeyFrameId id) {
  KeyFrame* keyframe = Edit(id);
  if (!keyframe || !keyframe->parent.valid()) return;  // the first one holds the world's frame
  const std::vector<LandmarkId> landmarks = keyframe->landmarks;
  for (LandmarkId landmark : landmarks) {
    if (landmark.valid()) RemoveObservation(landmark, id);
  }
  for (const Neighbour& neighbour : std::vector<Neighbour>(keyframe->covisible)) {
    if (KeyFrame* other = Edit(neighbour.id)) {
      std::erase_if(other->covisible, [&](const Neighbour& n) { return n.id == id; });
    }
  }
  for (uint32_t i = id.value + 1; i < state_.keyframes.next; ++i) {  // children are younger
    const KeyFrame* child = state_.keyframes.At(i);
    if (child && !child->culled() && child->parent == id)
      Edit(child->id)->parent = keyframe->parent;
  }
  const KeyFrame* parent = Find(keyframe->parent);
  keyframe->T_camera_parent = keyframe->T_camera_world * parent->T_camera_world.Inverse();
  keyframe->T_camera_parent.t /= parent->scale;
  keyframe->scale /= parent->scale;
  for (KeyFrameId other_id : keyframe->loops) {
    if (KeyFrame* other = Edit(other_id)) std::erase(other->loops, id);
  }
  keyframe->loops.clear();
  keyframe->frame = nullptr;
  keyframe->depth = nullptr;
  keyframe->landmarks.clear();
  keyframe->landmarks.shrink_to_fit();
  keyframe->covisible.clear();
  --state_.keyframes.alive;
}

void MapCommit::Remove(MapId id) {
  for (uint32_t i = 0; i < state_.landmarks.next; ++i) {
    const Landmark* landmark = Find(LandmarkId{i});
    if (!landmark || Find(landmark->reference)->map != id) continue;
    SetSlot<Landmark>(state_.landmarks, i, nullptr);
    --state_.landmarks.alive;
  }
  std::vector<uint32_t> gone;  // gathered first: a culled one's map is its parent's
  for (uint32_t i = 0; i < state_.keyframes.next; ++i) {
    if (state_.keyframes.At(i) && state_.MapOf({i}) == id) gone.push_back(i);
  }
  for (uint32_t i : gone) {
    state_.keyframes.alive -= !state_.keyframes.At(i)->culled();
    SetSlot<KeyFrame>(state_.keyframes, i, nullptr);
  }
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

void MapCommit::RefreshLandmark(LandmarkId id) {
  Landmark* landmark = Edit(id);
  if (!landmark) return;
  if (landmark->observations.empty()) return Remove(id);

  std::vector<const Descriptor*> descriptors;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  for (const Observation& seen : landmark->observations) {
    const KeyFrame* keyframe = Find(seen.keyframe);
    descriptors.push_back(&keyframe->frame->descriptors[seen.keypoint]);
    direction += (landmark->p_world - keyframe->Centre()).normalized();
  }
  // The descriptor with the least median distance to the others stands for all.
  size_t best = 0;
  int best_median = std::numeric_limits<int>::max();
  std::vector<int> distances(descriptors.size());
  for (size_t i = 0; i < descriptors.size() && descriptors.size() > 2; ++i) {
    for (size_t j = 0; j < descriptors.size(); ++j) {
      distances[j] = HammingDistance(*descriptors[i], *descriptors[j]);
    }
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>((distances.size() - 1) / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    if (*middle < best_median) {
      best_median = *middle;
      best = i;
    }
  }
  landmark->descriptor = *descriptors[best];
  landmark->normal = direction.normalized().cast<float>();

  const KeyFrame* reference = Find(landmark->reference);
  const auto seen =
      std::find_if(landmark->observations.begin(), landmark->observations.end(),
                   [&](const Observation& o) { return o.keyframe == landmark->reference; });
  const int level = reference->frame->keypoints[seen->keypoint].level;
  const double distance = (landmark->p_world - reference->Centre()).norm();
  landmark->max_distance = static_cast<float>(distance * ScaleOfLevel(level));
  landmark->min_distance =
      static_cast<float>(distance * ScaleOfLevel(level) / ScaleOfLevel(kPyramidLevels - 1));
}

void MapCommit::RefreshCovisibility(KeyFrameId id) {
  KeyFrame* keyframe = Edit(id);
  if (!keyframe) return;
  std::vector<int> shared(state_.keyframes.next, 0);
  for (LandmarkId landmark_id : keyframe->landmarks) {
    const Landmark* landmark = landmark_id.valid() ? Find(landmark_id) : nullptr;
    if (!landmark) continue;
    for (const Observation& seen : landmark->observations) ++shared[seen.keyframe.value];
  }
  shared[id.value] = 0;
  std::vector<Neighbour> neighbours;
  Neighbour best;
  for (uint32_t i = 0; i < shared.size(); ++i) {
    if (shared[i] >= kMinShared) neighbours.push_back({{i}, shared[i]});
    if (shared[i] > best.shared) best = {{i}, shared[i]};
  }
  if (neighbours.empty() && best.shared > 0) neighbours.push_back(best);
  std::sort(neighbours.begin(), neighbours.end(), MoreShared);

  const auto enter = [&](KeyFrameId other_id, int count) {
    KeyFrame* other = Edit(other_id);
    if (!other) return;
    std::erase_if(other->covisible, [&](const Neighbour& n) { return n.id == id; });
    if (count == 0) return;
    const Neighbour entry{id, count};
    other->covisible.insert(
        std::upper_bound(other->covisible.begin(), other->covisible.end(), entry, MoreShared),
        entry);
  };
  for (const Neighbour& old : keyframe->covisible) {
    const bool still = std::any_of(neighbours.begin(), neighbours.end(),
                                   [&](const Neighbour& n) { return n.id == old.id; });
    if (!still) enter(old.id, 0);
  }
  for (const Neighbour& neighbour : neighbours) enter(neighbour.id, neighbour.shared);
  keyframe->covisible = std::move(neighbours);
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
