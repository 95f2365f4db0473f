// The map: read through snapshots that never change, written through commits, one at a time.
// Objects sit behind shared pointers in pages of 64; a commit copies what it touches and publishes
// a new table, so that readers never wait and never see half a change.
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "alidade/map/keyframe.h"
#include "alidade/map/landmark.h"

namespace alidade {

template <typename Object>
struct MapPage {
  static constexpr uint32_t kSize = 64;
  std::array<std::shared_ptr<const Object>, kSize> slots;
  uint64_t version = 0;
};

template <typename Object>
struct MapTable {
  std::vector<std::shared_ptr<const MapPage<Object>>> pages;
  uint32_t next = 0;  // id the next object gets
  int alive = 0;

  const Object* At(uint32_t index) const {
    if (index >= next) return nullptr;
    return pages[index / MapPage<Object>::kSize]->slots[index % MapPage<Object>::kSize].get();
  }
};

struct MapState {
  MapTable<KeyFrame> keyframes;
  MapTable<Landmark> landmarks;
  uint32_t next_map = 0;     // id the next map gets
  uint64_t corrections = 0;  // how often loops, merges and full adjustments moved large parts
  uint64_t version = 0;

  // Of any keyframe that ever was; a culled one's follow its parent.
  Se3 PoseOf(KeyFrameId id) const;      // identity when its map was dropped
  double ScaleOf(KeyFrameId id) const;  // see KeyFrame::scale
  MapId MapOf(KeyFrameId id) const;     // none when its map was dropped
};

// A consistent view of the map at one moment. Cheap to copy, safe to keep.
class MapSnapshot {
 public:
  MapSnapshot() : state_(std::make_shared<const MapState>()) {}
  explicit MapSnapshot(std::shared_ptr<const MapState> state) : state_(std::move(state)) {}

  const KeyFrame* Find(KeyFrameId id) const {  // null when there is none or it was culled
    const KeyFrame* keyframe = state_->keyframes.At(id.value);
    return keyframe && !keyframe->culled() ? keyframe : nullptr;
  }
  const Landmark* Find(
      LandmarkId id) const {  // null when there is none, it was culled or fused away
    const Landmark* landmark = state_->landmarks.At(id.value);
    return landmark && !landmark->replaced_by.valid() ? landmark : nullptr;
  }
  // The landmark it was fused into, itself, or none when culled.
  LandmarkId Current(LandmarkId id) const;
  Se3 PoseOf(KeyFrameId id) const { return state_->PoseOf(id); }  // as in MapState
  double ScaleOf(KeyFrameId id) const { return state_->ScaleOf(id); }
  MapId MapOf(KeyFrameId id) const { return state_->MapOf(id); }

  std::vector<MapId> Maps() const;                       // that have keyframes, in order of id
  std::vector<KeyFrameId> KeyFramesOf(MapId map) const;  // alive, in order of id
  std::vector<KeyFrameId> KeyFrames() const;             // alive, in order of id
  std::vector<LandmarkId> Landmarks() const;             // alive, in order of id
  int keyframe_count() const { return state_->keyframes.alive; }
  int landmark_count() const { return state_->landmarks.alive; }
  uint32_t next_keyframe() const { return state_->keyframes.next; }
  uint32_t next_landmark() const { return state_->landmarks.next; }
  uint64_t version() const { return state_->version; }
  uint64_t corrections() const { return state_->corrections; }
  const MapState& state() const {
    return *state_;
  }  // all there is, the culled and fused included: for saving

 private:
  friend class MapStore;
  std::shared_ptr<const MapState> state_;
};

// One change of the map, seen by others only as a whole. Made by MapStore::Commit.
class MapCommit {
 public:
  // As in MapSnapshot, but with the changes made so far.
  const KeyFrame* Find(KeyFrameId id) const;
  const Landmark* Find(LandmarkId id) const;
  uint32_t next_keyframe() const { return state_.keyframes.next; }
  uint32_t next_landmark() const { return state_.landmarks.next; }

  KeyFrame* Edit(KeyFrameId id);  // null when it is not alive
  Landmark* Edit(LandmarkId id);

  const MapState& state() const { return state_; }

  // Sets its id; a parent removed meanwhile gives way to its own. Without a parent it is the first
  // of a new map.
  KeyFrameId Add(KeyFrame keyframe);
  LandmarkId Add(
      Landmark landmark);  // sets its id; its observations are entered in the keyframes too

  // Both sides of an observation. A keyframe sees a landmark at most once, a keypoint shows at most
  // one: does nothing and returns false when that would break, or one of them is gone.
  bool AddObservation(LandmarkId landmark, KeyFrameId keyframe, int keypoint);
  void RemoveObservation(LandmarkId landmark, KeyFrameId keyframe);

  void Remove(LandmarkId id);                   // and all its observations
  void Replace(LandmarkId old, LandmarkId by);  // moves the observations that fit, forwards the id
  void Remove(KeyFrameId id);  // hands its children to its parent; its observations go
  void Remove(MapId id);       // all that is in that map, without a trace
  void AddLoop(KeyFrameId a, KeyFrameId b);
  void CountCorrection() { ++state_.corrections; }

  // Recomputes what tracking needs to look for it. Removes it when no observation is left.
  void RefreshLandmark(LandmarkId id);
  // Recomputes the covisible list of one keyframe, and its entry in the others'.
  void RefreshCovisibility(KeyFrameId id);

 private:
  friend class MapStore;
  explicit MapCommit(const MapState& base) : state_(base) { ++state_.version; }
  template <typename Object>
  MapPage<Object>& EditPage(MapTable<Object>& table, uint32_t index);
  template <typename Object>
  Object* EditObject(MapTable<Object>& table, uint32_t index);
  template <typename Object>
  void SetSlot(MapTable<Object>& table, uint32_t index, std::shared_ptr<const Object> object);
  template <typename Object>
  uint32_t Append(MapTable<Object>& table, Object object);

  MapState state_;
};

class MapStore {
 public:
  MapStore() : current_(std::make_shared<const MapState>()) {}

  MapSnapshot Snapshot() const {
    std::lock_guard<std::mutex> lock(publish_mutex_);
    return MapSnapshot(current_);
  }

  // Runs change(MapCommit&) and publishes its result. Writers wait for each other, readers for
  // nobody.
  template <typename Change>
  MapSnapshot Commit(Change&& change) {
    std::lock_guard<std::mutex> writer(writer_mutex_);
    MapCommit commit(*Snapshot().state_);
    change(commit);
    return Publish(std::move(commit.state_));
  }
  // The same, but worked out beside other writers, who need not wait for a long change: done anew
  // on what they left when one of them was quicker, and at last with all of them waiting.
  template <typename Change>
  MapSnapshot CommitAside(Change&& change) {
    for (int attempt = 0; attempt < 3; ++attempt) {
      const MapSnapshot base = Snapshot();
      MapCommit commit(*base.state_);
      change(commit);
      std::lock_guard<std::mutex> writer(writer_mutex_);
      if (Snapshot().version() == base.version()) return Publish(std::move(commit.state_));
    }
    return Commit(change);
  }
  void Restore(const MapSnapshot&
                   saved);  // makes `saved` the map; its ids go on, versions of this store too

 private:
  MapSnapshot Publish(MapState&& state);

  mutable std::mutex publish_mutex_;
  std::mutex writer_mutex_;
  std::shared_ptr<const MapState> current_;
};

}  // namespace alidade
