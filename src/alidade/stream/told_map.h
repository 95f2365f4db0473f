// What a receiver of the stream knows of the map, and what must be told to bring it up to a newer
// snapshot. Finding that costs what has changed: snapshots share what has not (map/id_table.h).
#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "alidade/map/map_store.h"
#include "alidade/stream/settings.h"

namespace alidade {

// A landmark in its keyframe's camera, with lengths as if the keyframe's scale were 1.
struct ToldLandmark {
  KeyFrameId keyframe;
  Eigen::Vector3f p = Eigen::Vector3f::Zero();
};

struct ToldKeyFrame {
  MapId map;
  KeyFrameId parent;
  int number = 0;   // of its frame
  double time = 0;  // of its frame, seconds
  Se3 T_world_camera;
  double scale = 1;
  std::vector<KeyFrameId> covisible, loops;  // sorted
  std::shared_ptr<const DepthMap> depth;
};

// A keyframe that is no more: p(follows) = T_follows_culled * (scale * p(culled)), lengths as if
// the scale of `follows` were 1. None: its map is gone.
struct ToldCull {
  KeyFrameId id, follows;
  double scale = 1;
  Se3 T_follows_culled;
};

// By id, in order of it.
struct MapNews {
  std::vector<KeyFrameId> keyframes;  // new, or with other links, parent or map
  std::vector<KeyFrameId> moved;      // others that are elsewhere
  std::vector<KeyFrameId> depths;     // with other semi-dense depth
  std::vector<LandmarkId> landmarks;  // new or moved
  std::vector<LandmarkId> removed_landmarks;
  std::vector<ToldCull> culled;
  // What is worth an event.
  std::vector<std::pair<KeyFrameId, KeyFrameId>> loops;  // new ones, older keyframe first
  std::vector<std::pair<MapId, MapId>> merged;           // map, and the one it became part of
  std::vector<MapId> begun, given_up;
  bool empty() const {
    return keyframes.empty() && moved.empty() && depths.empty() && landmarks.empty() &&
           removed_landmarks.empty() && culled.empty();
  }
};

class ToldMap {
 public:
  explicit ToldMap(const StreamSettings& settings) : settings_(settings) {}

  // Takes over what `map` has other than what was told; not older than the one before.
  MapNews Update(const MapSnapshot& map);

  const std::unordered_map<uint32_t, ToldKeyFrame>& keyframes() const { return keyframes_; }
  const std::unordered_map<uint32_t, ToldLandmark>& landmarks() const { return landmarks_; }
  const MapSnapshot& snapshot() const { return snapshot_; }

 private:
  void UpdateKeyFrame(const KeyFrame& keyframe, MapNews& news);
  void UpdateLandmark(const Landmark& landmark, MapNews& news);
  ToldCull CullOf(KeyFrameId id, const MapSnapshot& map) const;

  StreamSettings settings_;
  MapSnapshot snapshot_;  // that was told
  std::unordered_map<uint32_t, ToldKeyFrame> keyframes_;
  std::unordered_map<uint32_t, ToldLandmark> landmarks_;
};

}  // namespace alidade
