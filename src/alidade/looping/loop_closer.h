// Notices that a place comes back, and makes the map agree with it (ORB-SLAM §VII).
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/looping/close.h"
#include "alidade/looping/settings.h"
#include "alidade/map/map_store.h"
#include "alidade/place/place_index.h"

namespace alidade {

class LoopCloser {
 public:
  // `camera`: as the frames are; depth_factor and baseline 0 for monocular use.
  LoopCloser(MapStore& map, PlaceIndex& places, const Camera& camera, LoopSettings settings);

  // The place a keyframe sees again, among keyframes of the index that `may_be` (empty: any) lets
  // pass; nothing when it is not certain.
  std::optional<LoopMatch> Recognise(const MapSnapshot& map, KeyFrameId id,
                                     const std::function<bool(KeyFrameId)>& may_be = {}) const;
  // Keyframes from `first` on are of one clock: the camera cannot have leapt between them. Any
  // thread's. Before the first call nothing is known of when keyframes were.
  void BeginRecording(KeyFrameId first) { recording_ = first; }
  // Enters a mapped keyframe into the index; a match when it sees an old place again.
  std::optional<LoopMatch> Add(KeyFrameId id);
  void SetEntered(std::vector<KeyFrameId> ids) { entered_ = std::move(ids); }  // of a loaded map
  // Closes the loop, or merges the two maps. The mapper must rest meanwhile, the tracker need not.
  // False when keyframe or place are gone.
  bool Close(const LoopMatch& match);
  // Full bundle adjustment of the map `id` is in. What is mapped meanwhile follows. `stop` (may be
  // null) cuts it short. `while_mapper_rests` runs what it is given at such a time: the commit,
  // which is dropped when another loop was closed meanwhile.
  void AdjustAll(KeyFrameId id, const std::atomic<bool>* stop,
                 const std::function<void(const std::function<void()>&)>& while_mapper_rests);

  // The map is of this camera from now on. Nothing else may be at work.
  void SetCamera(const Camera& camera) { camera_ = camera; }

  int loops() const { return loops_; }
  int merges() const { return merges_; }

 private:
  MapStore& map_;
  PlaceIndex& places_;
  Camera camera_;
  LoopSettings settings_;
  std::vector<KeyFrameId> entered_;  // into the index, and not seen to be culled yet; by id
  std::atomic<KeyFrameId> recording_{KeyFrameId{}};
  std::atomic<int> loops_{0}, merges_{0};
};

}  // namespace alidade
