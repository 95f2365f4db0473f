// Loop closure and map merging (Mur-Artal et al. 2015, §VII).
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

// Add() and Close() belong to one thread; AdjustAll() may run on another.
class LoopCloser {
 public:
  // `camera`: of the frames; depth_factor and baseline are 0 for monocular use.
  LoopCloser(MapStore& map, PlaceIndex& places, const Camera& camera, LoopSettings settings);

  // The place that a keyframe shows again, among keyframes of the index accepted by `may_be`
  // (empty: any); nullopt if it is not certain.
  std::optional<LoopMatch> Recognise(const MapSnapshot& map, KeyFrameId id,
                                     const std::function<bool(KeyFrameId)>& may_be = {}) const;
  // Keyframes from `first` on have times of one clock, so the motion gate applies between them.
  // Thread-safe. Before the first call, keyframe times are not used.
  void BeginRecording(KeyFrameId first) { recording_ = first; }
  // Adds a mapped keyframe to the index; returns a match if it shows an old place.
  std::optional<LoopMatch> Add(KeyFrameId id);
  // Keyframes of a loaded map that are already in the index.
  void SetEntered(std::vector<KeyFrameId> ids) { entered_ = std::move(ids); }
  // Closes the loop or merges the two maps. The mapper must be idle, tracking may continue. Returns
  // false if the keyframe or the place no longer exists.
  bool Close(const LoopMatch& match);
  // Bundle adjustment of the whole map that contains `id`; objects created meanwhile follow. `stop`
  // (may be null) ends it early. `while_mapper_rests` runs its argument while the mapper is idle;
  // the commit is dropped if another loop was closed meanwhile.
  void AdjustAll(KeyFrameId id, const std::atomic<bool>* stop,
                 const std::function<void(const std::function<void()>&)>& while_mapper_rests);

  // Changes the camera model of the map. No other thread may be using the map.
  void SetCamera(const Camera& camera) { camera_ = camera; }

  int loops() const { return loops_; }
  int merges() const { return merges_; }

 private:
  MapStore& map_;
  PlaceIndex& places_;
  Camera camera_;
  LoopSettings settings_;
  // Keyframes entered into the index, by id; may contain some that were culled since.
  std::vector<KeyFrameId> entered_;
  std::atomic<KeyFrameId> recording_{KeyFrameId{}};
  std::atomic<int> loops_{0}, merges_{0};
};

}  // namespace alidade
