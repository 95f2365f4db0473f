#include "alidade/mapping/fuse.h"

#include <algorithm>

#include "alidade/base/parallel.h"

namespace alidade {
std::vector<FusedSighting> FindDuplicates(const MapSnapshot& map, KeyFrameId id,
                                          const Camera& camera, const MapperSettings& settings) {
  const KeyFrame& keyframe = *map.Find(id);
  std::vector<const KeyFrame*> targets;
  for (const Neighbour& n : keyframe.covisible) {
    if (static_cast<int>(targets.size()) >= settings.fuse_keyframes) break;
    if (const KeyFrame* target = map.Find(n.id)) targets.push_back(target);
  }
  const LandmarkSearch search{settings.fuse_radius, settings.fuse_distance, settings.noise};
  // One search per neighbor, and one (the last) for all of their landmarks in this keyframe.
  std::vector<std::vector<FusedSighting>> found(targets.size() + 1);
  ParallelFor(static_cast<int>(found.size()), [&](int i) {
    if (i < static_cast<int>(targets.size())) {
      found[i] = FindLandmarks(map, keyframe.landmarks, *targets[i], targets[i]->T_camera_world,
                               camera, search);
      return;
    }
    std::vector<LandmarkId> theirs;
    for (const KeyFrame* target : targets) {
      theirs.insert(theirs.end(), target->landmarks.begin(), target->landmarks.end());
    }
    std::sort(theirs.begin(), theirs.end());
    theirs.erase(std::unique(theirs.begin(), theirs.end()), theirs.end());
    found[i] = FindLandmarks(map, theirs, keyframe, keyframe.T_camera_world, camera, search);
  });
  std::vector<FusedSighting> all;
  for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace alidade
