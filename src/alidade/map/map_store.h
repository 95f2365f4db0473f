// The map: read through snapshots that never change, written through commits, one at a time.
// Objects sit behind shared pointers in trees (id_table.h); a commit copies what it touches and
// publishes new trees, so that readers never wait and never see half a change.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/map/id_table.h"
#include "alidade/map/keyframe.h"
#include "alidade/map/landmark.h"

namespace ALIDADE_API alidade {

// What is left of a keyframe the map can do without: where it was, told by its parent, for those
// who were placed against it.
struct CulledKeyFrame {
  KeyFrameId id;
  KeyFrameId parent;     // living or culled itself
  Se3 T_camera_parent;   // had the parent scale 1
  double scale = 1;      // relative to the parent's, see KeyFrame::scale
  uint64_t version = 0;  // commit that removed it
};

// A landmark that was fused into another.
struct Forward {
  LandmarkId old, by;
  uint64_t version = 0;  // commit that fused them
};

// All there is. Ids are given forever, the tables hold what lives: their memory, and what a commit
// costs, does not depend on the past.
struct MapState {
  IdTable<KeyFrame> keyframes;  // alive
  IdTable<Landmark> landmarks;
  IdTable<CulledKeyFrame> culled;
  std::vector<Forward> forwards;  // by old id; until nobody holds that, see MapStore
  uint32_t next_keyframe = 0, next_landmark = 0, next_map = 0;  // ids the next ones get
  uint64_t corrections = 0;  // how often loops, merges and full adjustments moved large parts
  uint64_t version = 0;

  // Of any keyframe that is or was culled; a culled one's follow its parent.
  Se3 PoseOf(KeyFrameId id) const;      // identity when its map was dropped
  double ScaleOf(KeyFrameId id) const;  // see KeyFrame::scale
  MapId MapOf(KeyFrameId id) const;     // none when its map was dropped
};

// A consistent view of the map at one moment. Cheap to copy, safe to keep.
class MapSnapshot {
 public:
  MapSnapshot() : state_(std::make_shared<const MapState>()) {}
  explicit MapSnapshot(std::shared_ptr<const MapState> state) : state_(std::move(state)) {}

  // Null when there is none, or it was culled or fused away.
  const KeyFrame* Find(KeyFrameId id) const { return state_->keyframes.At(id.value); }
  const Landmark* Find(LandmarkId id) const { return state_->landmarks.At(id.value); }
  // The landmark it was fused into, itself, or none when culled. Ids older than what
  // MapStore::ReleaseLandmarkIds() was told are forwarded no more.
  LandmarkId Current(LandmarkId id) const;
  Se3 PoseOf(KeyFrameId id) const { return state_->PoseOf(id); }  // as in MapState
  double ScaleOf(KeyFrameId id) const { return state_->ScaleOf(id); }
  MapId MapOf(KeyFrameId id) const { return state_->MapOf(id); }

  std::vector<MapId> Maps() const;                       // that have keyframes, in order of id
  std::vector<KeyFrameId> KeyFramesOf(MapId map) const;  // alive, in order of id
  std::vector<KeyFrameId> KeyFrames() const;             // alive, in order of id
  std::vector<LandmarkId> Landmarks() const;             // alive, in order of id
  int keyframe_count() const { return state_->keyframes.size(); }
  int landmark_count() const { return state_->landmarks.size(); }
  const IdTable<KeyFrame>& keyframes() const { return state_->keyframes; }  // to walk through
  const IdTable<Landmark>& landmarks() const { return state_->landmarks; }
  uint32_t next_keyframe() const { return state_->next_keyframe; }
  uint32_t next_landmark() const { return state_->next_landmark; }
  uint64_t version() const { return state_->version; }
  uint64_t corrections() const { return state_->corrections; }
  const MapState& state() const { return *state_; }

 private:
  friend class MapStore;
  std::shared_ptr<const MapState> state_;
};

// Up to which commits nobody holds ids any more, see MapStore.
struct ReleasedIds {
  std::atomic<uint64_t> landmarks{0}, keyframes{0};
};

// One change of the map, seen by others only as a whole. Made by MapStore::Commit.
class MapCommit {
 public:
  // As in MapSnapshot, but with the changes made so far.
  const KeyFrame* Find(KeyFrameId id) const { return state_.keyframes.At(id.value); }
  const Landmark* Find(LandmarkId id) const { return state_.landmarks.At(id.value); }
  uint32_t next_keyframe() const { return state_.next_keyframe; }
  uint32_t next_landmark() const { return state_.next_landmark; }

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
  // Makes a map of its own of a keyframe and all younger ones of its map; returns it. Nothing
  // moves. Landmarks stay with the side their reference is on: the other side's observations of
  // them go, and with them the covisibility and the loops between the two. Nothing is done, and the
  // map as it is returned, when `first` is a map's first keyframe or isn't there.
  MapId Split(KeyFrameId first);
  void AddLoop(KeyFrameId a, KeyFrameId b);
  void CountCorrection() { ++state_.corrections; }

  // Recomputes what tracking needs to look for it. Removes it when no observation is left.
  void RefreshLandmark(LandmarkId id);
  // Recomputes the covisible list of one keyframe, and its entry in the others'.
  void RefreshCovisibility(KeyFrameId id);

 private:
  friend class MapStore;
  MapCommit(const MapState& base, const ReleasedIds& released);
  template <typename Object>
  Object* EditIn(IdTable<Object>& table, uint32_t id);

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
    MapCommit commit(*Snapshot().state_, released_);
    change(commit);
    return Publish(std::move(commit.state_));
  }
  // The same, but worked out beside other writers, who need not wait for a long change: done anew
  // on what they left when one of them was quicker, and at last with all of them waiting.
  template <typename Change>
  MapSnapshot CommitAside(Change&& change) {
    for (int attempt = 0; attempt < 3; ++attempt) {
      const MapSnapshot base = Snapshot();
      MapCommit commit(*base.state_, released_);
      change(commit);
      std::lock_guard<std::mutex> writer(writer_mutex_);
      if (Snapshot().version() == base.version()) return Publish(std::move(commit.state_));
    }
    return Commit(change);
  }
  // Makes `saved` the map; its ids go on, versions of this store too.
  void Restore(const MapSnapshot& saved);
  // Nobody holds landmark ids (ids of culled keyframes) of snapshots before `version` any more:
  // forwards (CulledKeyFrames) made up to then go with the next commit. Never told, they stay.
  void ReleaseLandmarkIds(uint64_t version) { released_.landmarks = version; }
  void ReleaseCulledKeyFrames(uint64_t version) { released_.keyframes = version; }

 private:
  MapSnapshot Publish(MapState&& state);

  mutable std::mutex publish_mutex_;
  std::mutex writer_mutex_;
  std::shared_ptr<const MapState> current_;
  ReleasedIds released_;
};

}  // namespace alidade
