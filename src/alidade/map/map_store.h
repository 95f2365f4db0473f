// The map. Readers use immutable snapshots; writers make commits, one at a time. Objects are held
// by shared pointers in trees (id_table.h); a commit copies what it changes and publishes new
// trees, so readers never wait and never see a partial change.
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
#include "alidade/map/map_world.h"

namespace ALIDADE_API alidade {

// Record of a culled keyframe: its pose relative to its parent, for poses anchored to it.
struct CulledKeyFrame {
  KeyFrameId id;
  KeyFrameId parent;     // live or culled
  Se3 T_camera_parent;   // for a parent of scale 1
  double scale = 1;      // relative to the parent's KeyFrame::scale
  uint64_t version = 0;  // commit that removed it
};

// A landmark that was merged into another.
struct Forward {
  LandmarkId old, by;
  uint64_t version = 0;  // commit that merged them
};

// The complete state. Ids are never reused, but the tables hold only existing objects, so memory
// and the cost of a commit do not depend on the history.
struct MapState {
  IdTable<KeyFrame> keyframes;  // live
  IdTable<Landmark> landmarks;
  IdTable<CulledKeyFrame> culled;
  std::vector<Forward> forwards;  // sorted by old id; kept until released, see MapStore
  std::vector<MapWorld> worlds;   // of maps of which something is known, by map
  uint32_t next_keyframe = 0, next_landmark = 0, next_map = 0;  // next ids to issue
  uint64_t corrections = 0;  // number of loop closures, merges and full adjustments so far
  uint64_t version = 0;

  // Of a live or culled keyframe; a culled one follows its parent.
  Se3 PoseOf(KeyFrameId id) const;      // identity if its map was dropped
  double ScaleOf(KeyFrameId id) const;  // see KeyFrame::scale
  MapId MapOf(KeyFrameId id) const;     // invalid if its map was dropped
};

// Consistent view of the map at one moment. Cheap to copy; may be kept for any time.
class MapSnapshot {
 public:
  MapSnapshot() : state_(std::make_shared<const MapState>()) {}
  explicit MapSnapshot(std::shared_ptr<const MapState> state) : state_(std::move(state)) {}

  // Null if it never existed, or was culled or merged.
  const KeyFrame* Find(KeyFrameId id) const { return state_->keyframes.At(id.value); }
  const Landmark* Find(LandmarkId id) const { return state_->landmarks.At(id.value); }
  // Follows merges: the id of the landmark now, or invalid if it was culled. Ids from snapshots
  // released by MapStore::ReleaseLandmarkIds() are not resolved.
  LandmarkId Current(LandmarkId id) const;
  Se3 PoseOf(KeyFrameId id) const { return state_->PoseOf(id); }  // see MapState
  double ScaleOf(KeyFrameId id) const { return state_->ScaleOf(id); }
  MapId MapOf(KeyFrameId id) const { return state_->MapOf(id); }

  // What is known of a map's world; null: nothing.
  const MapWorld* WorldOf(MapId map) const { return FindWorld(state_->worlds, map); }

  std::vector<MapId> Maps() const;                       // maps with keyframes, in order of ids
  std::vector<KeyFrameId> KeyFramesOf(MapId map) const;  // live, in order of ids
  std::vector<KeyFrameId> KeyFrames() const;             // live, in order of ids
  std::vector<LandmarkId> Landmarks() const;             // live, in order of ids
  int keyframe_count() const { return state_->keyframes.size(); }
  int landmark_count() const { return state_->landmarks.size(); }
  const IdTable<KeyFrame>& keyframes() const { return state_->keyframes; }  // for iteration
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

// Versions up to which no ids are held any more, see MapStore.
struct ReleasedIds {
  std::atomic<uint64_t> landmarks{0}, keyframes{0};
};

// One atomic change of the map. Created by MapStore::Commit().
class MapCommit {
 public:
  // As in MapSnapshot, including the changes made so far.
  const KeyFrame* Find(KeyFrameId id) const { return state_.keyframes.At(id.value); }
  const Landmark* Find(LandmarkId id) const { return state_.landmarks.At(id.value); }
  uint32_t next_keyframe() const { return state_.next_keyframe; }
  uint32_t next_landmark() const { return state_.next_landmark; }

  KeyFrame* Edit(KeyFrameId id);  // null if it is not alive
  Landmark* Edit(LandmarkId id);

  const MapState& state() const { return state_; }

  // Adds a keyframe and sets its id. A parent removed meanwhile is replaced by its own parent.
  // Without a parent it starts a new map.
  KeyFrameId Add(KeyFrame keyframe);
  // Adds a landmark, sets its id, and enters its observations in the keyframes.
  LandmarkId Add(Landmark landmark);

  // Adds both sides of an observation. A keyframe observes a landmark at most once, and a keypoint
  // at most one landmark: returns false and changes nothing if that would be violated or an object
  // does not exist.
  bool AddObservation(LandmarkId landmark, KeyFrameId keyframe, int keypoint);
  void RemoveObservation(LandmarkId landmark, KeyFrameId keyframe);

  void Remove(LandmarkId id);  // with its observations
  // Moves the observations that fit to `by`, removes `old` and forwards its id.
  void Replace(LandmarkId old, LandmarkId by);
  // Removes a keyframe and its observations; its children get its parent. The first keyframe of a
  // map stays.
  void Remove(KeyFrameId id);
  void Remove(MapId id);  // the whole map, including records of culled keyframes
  // Splits a map: `first` and all younger keyframes of its map form a new map, whose id is
  // returned. Nothing moves. A landmark stays in the part of its reference keyframe; its
  // observations from the other part, and covisibility and loops between the parts, are removed. If
  // `first` is the first keyframe of a map, nothing is changed and its map's id is returned; if it
  // does not exist, an invalid id.
  MapId Split(KeyFrameId first);
  // Replaces what is known of the world of `world.map`.
  void SetWorld(const MapWorld& world);
  void ForgetWorld(MapId map);
  void AddLoop(KeyFrameId a, KeyFrameId b);
  void CountCorrection() { ++state_.corrections; }

  // Recomputes the search data of a landmark. Removes it if it has no observations.
  void RefreshLandmark(LandmarkId id);
  // Recomputes the covisible list of a keyframe and its entries in other keyframes' lists.
  void RefreshCovisibility(KeyFrameId id);

 private:
  friend class MapStore;
  MapCommit(const MapState& base, const ReleasedIds& released);
  void JoinMotions(const KeyFrame& gone);
  template <typename Object>
  Object* EditIn(IdTable<Object>& table, uint32_t id);

  MapState state_;
};

// Thread-safe.
class MapStore {
 public:
  MapStore() : current_(std::make_shared<const MapState>()) {}

  MapSnapshot Snapshot() const {
    std::lock_guard<std::mutex> lock(publish_mutex_);
    return MapSnapshot(current_);
  }

  // Runs change(MapCommit&) and publishes the result. Writers are serialized; readers do not wait.
  template <typename Change>
  MapSnapshot Commit(Change&& change) {
    std::lock_guard<std::mutex> writer(writer_mutex_);
    MapCommit commit(*Snapshot().state_, released_);
    change(commit);
    return Publish(std::move(commit.state_));
  }
  // Like Commit(), but without blocking other writers during `change`. If another commit was
  // published meanwhile, `change` is repeated on the new state; the fourth attempt blocks.
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
  // Replaces the map by `saved`; ids continue after those of `saved`, versions after the larger of
  // both.
  void Restore(const MapSnapshot& saved);
  // Declares that no landmark ids (ids of culled keyframes) from snapshots before `version` are
  // held any more. The next commit drops the corresponding forwards (CulledKeyFrames). Without
  // these calls they are kept.
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
