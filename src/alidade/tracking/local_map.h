// The part of the map a frame can be expected to see (ORB-SLAM §V-D).
#pragma once

#include <span>
#include <vector>

#include "alidade/base/id_map.h"
#include "alidade/map/map_store.h"

namespace alidade {

struct LocalMap {
  // Those that share landmarks with the frame, those that look the same way from nearby (where
  // covisibility was lost by a turn away and back), then their neighbours.
  std::vector<KeyFrameId> keyframes;
  std::vector<const Landmark*> landmarks;  // all they see, each once; valid as long as the snapshot
  KeyFrameId reference;                    // the one that shares most
};

// Keeps the memory of its marks between frames.
class LocalMapGatherer {
 public:
  // `matches`: the frame's landmarks so far (invalid and stale ids are passed over).
  LocalMap Gather(const MapSnapshot& map, std::span<const LandmarkId> matches,
                  const Se3& T_camera_world, int max_keyframes);

 private:
  IdSet<LandmarkId> landmarks_taken_;
  IdSet<KeyFrameId> keyframes_taken_;
  IdMap<KeyFrameId, int> votes_;  // landmarks of the frame each sees
};

}  // namespace alidade
