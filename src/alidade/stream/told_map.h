// The map as known to the receivers of the stream, and its difference to a newer snapshot. The cost
// is proportional to the changes, because snapshots share unchanged nodes (map/id_table.h).
#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "alidade/map/map_store.h"
#include "alidade/stream/settings.h"

namespace alidade {

// In the camera of its keyframe, with lengths scaled as if the keyframe's scale were 1.
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

// A removed keyframe: p(follows) = T_follows_culled * (scale * p(culled)), with lengths scaled as
// if the scale of `follows` were 1. `follows` invalid: its map was removed.
struct ToldCull {
  KeyFrameId id, follows;
  double scale = 1;
  Se3 T_follows_culled;
};

// All lists are sorted by id.
struct MapNews {
  std::vector<KeyFrameId> keyframes;  // new, or with changed links, parent or map
  std::vector<KeyFrameId> moved;      // others whose pose changed
  std::vector<KeyFrameId> depths;     // with changed semi-dense depth
  std::vector<LandmarkId> landmarks;  // new or moved
  std::vector<LandmarkId> removed_landmarks;
  std::vector<ToldCull> culled;
  // Reported as events.
  std::vector<std::pair<KeyFrameId, KeyFrameId>> loops;  // new ones, older keyframe first
  std::vector<std::pair<MapId, MapId>> merged;           // a map, and the map it became part of
  std::vector<MapId> begun, given_up;
  bool worlds = false;  // what is known of the worlds of maps has changed
  bool empty() const {
    return !worlds && keyframes.empty() && moved.empty() && depths.empty() && landmarks.empty() &&
           removed_landmarks.empty() && culled.empty();
  }
};

class ToldMap {
 public:
  explicit ToldMap(const StreamSettings& settings) : settings_(settings) {}

  // Adopts `map`, which must not be older than the previous one, and returns the difference.
  MapNews Update(const MapSnapshot& map);

  const std::unordered_map<uint32_t, ToldKeyFrame>& keyframes() const { return keyframes_; }
  const std::unordered_map<uint32_t, ToldLandmark>& landmarks() const { return landmarks_; }
  const MapSnapshot& snapshot() const { return snapshot_; }

 private:
  void UpdateKeyFrame(const KeyFrame& keyframe, MapNews& news);
  void UpdateLandmark(const Landmark& landmark, MapNews& news);
  ToldCull CullOf(KeyFrameId id, const MapSnapshot& map) const;

  StreamSettings settings_;
  MapSnapshot snapshot_;  // the snapshot sent last
  std::unordered_map<uint32_t, ToldKeyFrame> keyframes_;
  std::unordered_map<uint32_t, ToldLandmark> landmarks_;
};

}  // namespace alidade
