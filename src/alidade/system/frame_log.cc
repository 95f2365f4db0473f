#include "alidade/system/frame_log.h"

#include <algorithm>
#include <iterator>
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
  placed_ = true;
}

void FrameLog::End() {
  if (!begun_) return;
  if (open_count_ == kChunk) Seal();
  if (!writing_) writing_ = std::make_shared<Records>();
  Record& record = (*writing_)[static_cast<size_t>(open_count_)];
  record.time = time_;
  if (placed_) {
    record.anchor = AnchorOf(anchor_.keyframe);
    anchor_.T_camera_keyframe.t /= anchor_.scale;
    record.T_camera_anchor = Pack(anchor_.T_camera_keyframe);
    record.T_world_camera_live = Pack(live_);
  }
  std::lock_guard<std::mutex> lock(mutex_);
  open_.records = writing_;
  open_.age = age_;
  open_.tracked += placed_;
  ++open_count_;
  begun_ = placed_ = false;
}

// Index of the keyframe in the open chunk's table.
int FrameLog::AnchorOf(KeyFrameId keyframe) {
  std::shared_ptr<const AnchorTable> table = open_.anchors;
  const int index = AnchorIn(table, first_of_open_ / kChunk, keyframe);
  if (table == open_.anchors) return index;
  std::lock_guard<std::mutex> lock(mutex_);
  open_.anchors = std::move(table);
  return index;
}

// Index of the keyframe in the table of chunk `number`. If it is missing, a longer copy replaces
// the table, because readers may hold the old one.
int FrameLog::AnchorIn(std::shared_ptr<const AnchorTable>& table, int number, KeyFrameId keyframe) {
  const auto same = [&](const ChunkAnchor& a) { return a.placed == keyframe; };
  if (table) {
    const auto at = std::find_if(table->rbegin(), table->rend(), same);
    if (at != table->rend()) return static_cast<int>(table->rend() - at) - 1;
  }
  auto longer = table ? std::make_shared<AnchorTable>(*table) : std::make_shared<AnchorTable>();
  longer->push_back({keyframe, keyframe, {}, 1});
  std::vector<int>& chunks = chunks_of_[keyframe];
  const auto at = std::lower_bound(chunks.begin(), chunks.end(), number);
  if (at == chunks.end() || *at != number) chunks.insert(at, number);
  table = std::move(longer);
  return static_cast<int>(table->size()) - 1;
}

void FrameLog::PlaceLate(int index, Anchor anchor) {
  const int number = index / kChunk;
  const bool open = number == first_of_open_ / kChunk;
  if (number < first_chunk_ || index >= first_of_open_ + open_count_) return;
  Chunk chunk = open ? open_ : (*full_)[static_cast<size_t>(number - first_chunk_)];
  auto records = std::make_shared<Records>(*chunk.records);
  Record& record = (*records)[static_cast<size_t>(index % kChunk)];
  if (record.anchor < 0) {
    record.late = true;
    ++chunk.tracked;
  }
  record.anchor = AnchorIn(chunk.anchors, number, anchor.keyframe);
  anchor.T_camera_keyframe.t /= anchor.scale;
  record.T_camera_anchor = Pack(anchor.T_camera_keyframe);
  chunk.records = records;
  if (open) {
    writing_ = records;
    std::lock_guard<std::mutex> lock(mutex_);
    open_ = std::move(chunk);
    return;
  }
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
  if (old == 0) return;
  for (auto it = chunks_of_.begin(); it != chunks_of_.end();) {
    std::erase_if(it->second, [&](int number) { return number < first_chunk_; });
    it = it->second.empty() ? chunks_of_.erase(it) : std::next(it);
  }
}

void FrameLog::Reanchor(const MapSnapshot& map) {
  std::vector<KeyFrameId> culled;
  for (const auto& [id, chunks] : chunks_of_) {
    if (id.value < map.next_keyframe() && !map.Find(id)) culled.push_back(id);
  }
  if (culled.empty()) return;
  const int open_number = first_of_open_ / kChunk;
  const auto table_of = [&](int number) -> const AnchorTable& {
    const Chunk& chunk =
        number == open_number ? open_ : (*full_)[static_cast<size_t>(number - first_chunk_)];
    return *chunk.anchors;
  };
  std::map<int, std::shared_ptr<AnchorTable>> changed;  // by chunk number
  for (KeyFrameId id : culled) {
    const std::vector<int> numbers = std::move(chunks_of_[id]);
    chunks_of_.erase(id);
    const KeyFrameId heir = Reanchored(map.state(), {id, {}, 1}).keyframe;
    for (int number : numbers) {
      auto& table = changed[number];
      if (!table) table = std::make_shared<AnchorTable>(table_of(number));
      for (ChunkAnchor& anchor : *table) {
        if (anchor.keyframe != id) continue;
        anchor.T_placed_keyframe =
            Reanchored(map.state(), {id, anchor.T_placed_keyframe, 1}).T_camera_keyframe;
        if (heir.valid()) anchor.scale *= map.ScaleOf(id) / map.ScaleOf(heir);
        anchor.keyframe = heir;
      }
    }
    if (!heir.valid()) continue;
    std::vector<int> both;
    std::vector<int>& before = chunks_of_[heir];
    std::set_union(numbers.begin(), numbers.end(), before.begin(), before.end(),
                   std::back_inserter(both));
    before = std::move(both);
  }
  auto full = std::make_shared<std::vector<Chunk>>(*full_);
  for (const auto& [number, table] : changed) {
    if (number != open_number) (*full)[static_cast<size_t>(number - first_chunk_)].anchors = table;
  }
  std::lock_guard<std::mutex> lock(mutex_);
  full_ = std::move(full);
  if (const auto open = changed.find(open_number); open != changed.end())
    open_.anchors = open->second;
}

std::vector<KeyFrameId> FrameLog::Anchors() const {
  std::vector<KeyFrameId> anchors;
  for (const auto& [id, chunks] : chunks_of_) anchors.push_back(id);
  return anchors;
}

std::vector<FramePose> FrameLog::Trajectory(const MapStore& store, int since) const {
  std::shared_ptr<const std::vector<Chunk>> full;
  Chunk open;
  int first = 0, end = 0;
  std::vector<int> recordings;
  MapSnapshot map;
  {
    // The snapshot is taken under the lock. The map forgets culled keyframes only after Reanchor(),
    // so it still has every anchor that is read here.
    std::lock_guard<std::mutex> lock(mutex_);
    full = full_;
    open = open_;
    first = first_chunk_ * kChunk;
    end = first_of_open_ + open_count_;
    recordings = recordings_;
    map = store.Snapshot();
  }
  struct Place {  // current pose of an anchor
    MapId map;
    Se3 T_anchor_world;
    double scale = 1;
    const ChunkAnchor* anchor = nullptr;
  };
  std::vector<Place> places;
  std::vector<FramePose> trajectory;
  int chunk_in_use = -1;
  for (int index = std::max(first, since); index < end; ++index) {
    const auto number = static_cast<size_t>((index - first) / kChunk);
    const Chunk& chunk = number < full->size() ? (*full)[number] : open;
    if (chunk_in_use != static_cast<int>(number) && chunk.anchors) {
      chunk_in_use = static_cast<int>(number);
      places.clear();
      for (const ChunkAnchor& anchor : *chunk.anchors) {
        Place place;
        place.anchor = &anchor;
        place.map = map.MapOf(anchor.keyframe);
        if (place.map.valid()) {
          const double scale = map.ScaleOf(anchor.keyframe);
          place.scale = anchor.scale * scale;
          Se3 T_placed_keyframe = anchor.T_placed_keyframe;
          T_placed_keyframe.t *= scale;
          place.T_anchor_world = T_placed_keyframe * map.PoseOf(anchor.keyframe);
        }
        places.push_back(place);
      }
    }
    const Record& record = (*chunk.records)[static_cast<size_t>(index % kChunk)];
    FramePose pose;
    pose.index = index;
    pose.time = record.time;
    pose.recording = static_cast<int>(
        std::upper_bound(recordings.begin(), recordings.end(), index) - recordings.begin());
    if (record.anchor >= 0) {
      const Place& place = places[static_cast<size_t>(record.anchor)];
      pose.map = place.map;
      pose.tracked = place.map.valid();  // false if its map was dropped
      if (pose.tracked) {
        Se3 T_camera_anchor = Unpack(record.T_camera_anchor);
        T_camera_anchor.t *= place.anchor->scale;
        pose.reference = place.anchor->keyframe;
        pose.T_reference_camera = (T_camera_anchor * place.anchor->T_placed_keyframe).Inverse();
        T_camera_anchor = Unpack(record.T_camera_anchor);
        T_camera_anchor.t *= place.scale;
        pose.T_world_camera = (T_camera_anchor * place.T_anchor_world).Inverse();
        pose.late = record.late;
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
  size_t bytes = (full_->size() + (open_.records ? 1 : 0)) * sizeof(Records);
  const auto table = [](const Chunk& chunk) {
    return chunk.anchors ? chunk.anchors->capacity() * sizeof(ChunkAnchor) : 0;
  };
  for (const Chunk& chunk : *full_) bytes += sizeof(Chunk) + table(chunk);
  return bytes + table(open_);
}

}  // namespace alidade
