// The part of the map that a frame is expected to observe (Mur-Artal et al. 2015, §V-D).
#pragma once

#include <span>
#include <vector>

#include "alidade/base/id_map.h"
#include "alidade/map/map_store.h"

namespace alidade {

struct LocalMap {
  // Keyframes that share landmarks with the frame; those with a similar pose (covisibility is lost
  // when the camera turns away and back); then covisible keyframes of both.
  std::vector<KeyFrameId> keyframes;
  // All they observe, without duplicates; valid as long as the snapshot.
  std::vector<const Landmark*> landmarks;
  KeyFrameId reference;  // the keyframe that shares the most landmarks
};

// Reuses its buffers between frames; one thread at a time.
class LocalMapGatherer {
 public:
  // `matches`: the frame's landmarks so far (invalid and outdated ids are ignored).
  LocalMap Gather(const MapSnapshot& map, std::span<const LandmarkId> matches,
                  const Se3& T_camera_world, int max_keyframes);

 private:
  IdSet<LandmarkId> landmarks_taken_;
  IdSet<KeyFrameId> keyframes_taken_;
  IdMap<KeyFrameId, int> votes_;  // number of the frame's landmarks that each keyframe observes
};

}  // namespace alidade
