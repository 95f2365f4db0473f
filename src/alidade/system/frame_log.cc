#include "alidade/system/frame_log.h"

#include <algorithm>
#include <cstdint>
#include <type_traits>
#include <unordered_map>
#include <utility>

namespace alidade {

FrameLog::FrameLog(const TrajectorySettings& settings)
    : settings_(settings), full_(std::make_shared<const std::vector<Chunk>>()) {}

void FrameLog::Begin(double time) {
  End();
  if (!empty()) age_ += std::max(0.0, time - time_);
  time_ = time;
  begun_ = true;
}

void FrameLog::BeginRecording() {
  std::lock_guard<std::mutex> lock(mutex_);
  recordings_.push_back(size());
}

void FrameLog::Place(const Anchor& anchor, const Se3& T_world_camera_live) {
  anchor_ = anchor;
  live_ = T_world_camera_live;
  placed_now_ = true;
}

FrameLog::Pose FrameLog::Pack(const Se3& pose) {
  const Eigen::Quaterniond q = pose.Quaternion();
  return {q.x(), q.y(), q.z(), q.w(), pose.t.x(), pose.t.y(), pose.t.z()};
}

Se3 FrameLog::Unpack(const Pose& pose) {
  const Eigen::Quaterniond q(pose[3], pose[0], pose[1], pose[2]);
  return {q.toRotationMatrix(), {pose[4], pose[5], pose[6]}};
}

void FrameLog::End() {
  if (!begun_) return;
  if (open_count_ == kChunk) Seal();
  if (!writing_) writing_ = std::make_shared<Records>();
  Record& record = (*writing_)[static_cast<size_t>(open_count_)];
  record.time = time_;
  if (placed_now_) {
    Use(anchor_.keyframe, first_of_open_ / kChunk);
    record.placed = anchor_.keyframe;
    anchor_.T_camera_keyframe.t /= anchor_.scale;
    record.T_camera_placed = Pack(anchor_.T_camera_keyframe);
    record.T_world_camera_live = Pack(live_);
  }
  std::lock_guard<std::mutex> lock(mutex_);
  open_.records = writing_;
  open_.age = age_;
  open_.tracked += placed_now_;
  ++open_count_;
  begun_ = placed_now_ = false;
}

// Notes that poses of chunk `chunk` are placed by `keyframe`.
void FrameLog::Use(KeyFrameId keyframe, int chunk) {
  if (!keyframe.valid()) return;
  int& last = last_use_.try_emplace(keyframe, chunk).first->second;
  last = std::max(last, chunk);
  if (placed_.At(keyframe.value)) return;
  moves_[keyframe].push_back(keyframe);
  IdTable<Placed> placed = placed_;
  placed.Set(keyframe.value, std::make_shared<Placed>(Placed{keyframe, keyframe, {}, 1}),
             ++version_);
  std::lock_guard<std::mutex> lock(mutex_);
  placed_ = std::move(placed);
}

std::shared_ptr<const FrameLog::Records> FrameLog::RecordsOf(const Chunk& chunk) {
  if (chunk.records) return chunk.records;
  const auto records = std::make_shared<Records>();
  static_assert(std::is_trivially_copyable_v<Record>);
  chunk.stored->Read({reinterpret_cast<char*>(records->data()), sizeof(Records)});
  return records;
}

// Moves the records of a full chunk out of memory, if there is a place.
void FrameLog::Store(Chunk& chunk) const {
  if (!store_ || !chunk.records) return;
  chunk.stored =
      store_->Put({reinterpret_cast<const char*>(chunk.records->data()), sizeof(Records)});
  if (chunk.stored) chunk.records = nullptr;
}

void FrameLog::PlaceLate(int index, Anchor anchor) {
  const int number = index / kChunk;
  const bool open = number == first_of_open_ / kChunk;
  if (number < first_chunk_ || index >= first_of_open_ + open_count_) return;
  Chunk chunk = open ? open_ : (*full_)[static_cast<size_t>(number - first_chunk_)];
  auto records = std::make_shared<Records>(*RecordsOf(chunk));
  Record& record = (*records)[static_cast<size_t>(index % kChunk)];
  if (!record.placed.valid()) {
    record.late = 1;
    ++chunk.tracked;
  }
  Use(anchor.keyframe, number);
  record.placed = anchor.keyframe;
  anchor.T_camera_keyframe.t /= anchor.scale;
  record.T_camera_placed = Pack(anchor.T_camera_keyframe);
  chunk.records = records;
  if (open) {
    writing_ = records;
    std::lock_guard<std::mutex> lock(mutex_);
    open_ = std::move(chunk);
    return;
  }
  if (chunk.stored) Store(chunk);
  auto full = std::make_shared<std::vector<Chunk>>(*full_);
  (*full)[static_cast<size_t>(number - first_chunk_)] = std::move(chunk);
  std::lock_guard<std::mutex> lock(mutex_);
  full_ = std::move(full);
}

// Moves the open chunk, which is full, to full_, and drops chunks older than keep_seconds.
void FrameLog::Seal() {
  auto full = std::make_shared<std::vector<Chunk>>(*full_);
  full->push_back(open_);
  int tracked = 0;
  size_t old = 0;  // chunks to drop
  while (settings_.keep_seconds > 0 && old < full->size() &&
         (*full)[old].age < age_ - settings_.keep_seconds) {
    tracked += (*full)[old].tracked;
    ++old;
  }
  full->erase(full->begin(), full->begin() + static_cast<std::ptrdiff_t>(old));
  if (full->size() > kInMemory) Store((*full)[full->size() - 1 - kInMemory]);
  writing_ = nullptr;
  {
    std::lock_guard<std::mutex> lock(mutex_);
    full_ = std::move(full);
    first_chunk_ += static_cast<int>(old);
    let_go_.frames += static_cast<int>(old) * kChunk;
    let_go_.tracked += tracked;
    open_ = {};
    first_of_open_ += kChunk;
    open_count_ = 0;
  }
  if (old > 0) ForgetPlacedBefore(first_chunk_);
}

// What only chunks before that number are placed by.
void FrameLog::ForgetPlacedBefore(int chunk) {
  IdTable<Placed> placed = placed_;
  ++version_;
  for (auto it = last_use_.begin(); it != last_use_.end();) {
    if (it->second >= chunk) {
      ++it;
      continue;
    }
    const KeyFrameId mover = placed.At(it->first.value)->keyframe;
    if (const auto moved = moves_.find(mover); moved != moves_.end()) {
      std::erase(moved->second, it->first);
      if (moved->second.empty()) moves_.erase(moved);
    }
    placed.Erase(it->first.value, version_);
    it = last_use_.erase(it);
  }
  std::lock_guard<std::mutex> lock(mutex_);
  placed_ = std::move(placed);
}

void FrameLog::Reanchor(const MapSnapshot& map) {
  std::vector<KeyFrameId> culled;
  for (const auto& [id, moved] : moves_) {
    if (id.value < map.next_keyframe() && !map.Find(id)) culled.push_back(id);
  }
  if (culled.empty()) return;
  IdTable<Placed> placed = placed_;
  ++version_;
  for (KeyFrameId id : culled) {
    const std::vector<KeyFrameId> moved = std::move(moves_[id]);
    moves_.erase(id);
    const KeyFrameId heir = Reanchored(map.state(), {id, {}, 1}).keyframe;
    for (KeyFrameId one : moved) {
      Placed now = *placed.At(one.value);
      now.T_placed_keyframe =
          Reanchored(map.state(), {id, now.T_placed_keyframe, 1}).T_camera_keyframe;
      if (heir.valid()) now.scale *= map.ScaleOf(id) / map.ScaleOf(heir);
      now.keyframe = heir;
      placed.Set(one.value, std::make_shared<Placed>(now), version_);
    }
    if (!heir.valid()) continue;
    std::vector<KeyFrameId>& all = moves_[heir];
    all.insert(all.end(), moved.begin(), moved.end());
  }
  std::lock_guard<std::mutex> lock(mutex_);
  placed_ = std::move(placed);
}

std::vector<KeyFrameId> FrameLog::Anchors() const {
  std::vector<KeyFrameId> anchors;
  for (const auto& [id, moved] : moves_) anchors.push_back(id);
  return anchors;
}

std::vector<FramePose> FrameLog::Trajectory(const MapStore& store, int since) const {
  std::shared_ptr<const std::vector<Chunk>> full;
  IdTable<Placed> placed;
  Chunk open;
  int first = 0, end = 0;
  std::vector<int> recordings;
  MapSnapshot map;
  {
    // The snapshot is taken under the lock. The map forgets culled keyframes only after Reanchor(),
    // so it still has every anchor that is read here.
    std::lock_guard<std::mutex> lock(mutex_);
    full = full_;
    placed = placed_;
    open = open_;
    first = first_chunk_ * kChunk;
    end = first_of_open_ + open_count_;
    recordings = recordings_;
    map = store.Snapshot();
  }
  struct Place {  // where a keyframe that poses are relative to is now
    MapId map;
    Se3 T_placed_world;
    double scale = 1;
    const Placed* placed = nullptr;
  };
  std::unordered_map<uint32_t, Place> places;
  const auto place_of = [&](KeyFrameId id) -> const Place& {
    const auto [at, fresh] = places.try_emplace(id.value);
    Place& place = at->second;
    if (!fresh) return place;
    place.placed = placed.At(id.value);
    place.map = map.MapOf(place.placed->keyframe);
    if (!place.map.valid()) return place;
    const double scale = map.ScaleOf(place.placed->keyframe);
    place.scale = place.placed->scale * scale;
    Se3 T_placed_keyframe = place.placed->T_placed_keyframe;
    T_placed_keyframe.t *= scale;
    place.T_placed_world = T_placed_keyframe * map.PoseOf(place.placed->keyframe);
    return place;
  };
  std::vector<FramePose> trajectory;
  trajectory.reserve(static_cast<size_t>(std::max(0, end - std::max(first, since))));
  size_t chunk_in_use = SIZE_MAX;
  std::shared_ptr<const Records> records;
  for (int index = std::max(first, since); index < end; ++index) {
    const auto number = static_cast<size_t>((index - first) / kChunk);
    if (std::exchange(chunk_in_use, number) != number)
      records = RecordsOf(number < full->size() ? (*full)[number] : open);
    const Record& record = (*records)[static_cast<size_t>(index % kChunk)];
    FramePose pose;
    pose.index = index;
    pose.time = record.time;
    pose.recording = static_cast<int>(
        std::upper_bound(recordings.begin(), recordings.end(), index) - recordings.begin());
    if (record.placed.valid()) {
      const Place& place = place_of(record.placed);
      pose.map = place.map;
      pose.tracked = place.map.valid();  // false if its map was dropped
      if (pose.tracked) {
        Se3 T_camera_placed = Unpack(record.T_camera_placed);
        T_camera_placed.t *= place.placed->scale;
        pose.reference = place.placed->keyframe;
        pose.T_reference_camera = (T_camera_placed * place.placed->T_placed_keyframe).Inverse();
        T_camera_placed = Unpack(record.T_camera_placed);
        T_camera_placed.t *= place.scale;
        pose.T_world_camera = (T_camera_placed * place.T_placed_world).Inverse();
        pose.late = record.late != 0;
        if (!pose.late) pose.T_world_camera_live = Unpack(record.T_world_camera_live);
      }
    }
    trajectory.push_back(pose);
  }
  return trajectory;
}

LetGoFrames FrameLog::let_go() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return let_go_;
}

size_t FrameLog::bytes() const {
  std::lock_guard<std::mutex> lock(mutex_);
  size_t bytes =
      full_->size() * sizeof(Chunk) + static_cast<size_t>(placed_.size()) * sizeof(Placed);
  if (open_.records) bytes += sizeof(Records);
  for (const Chunk& chunk : *full_) bytes += chunk.records ? sizeof(Records) : 0;
  return bytes;
}

}  // namespace alidade
