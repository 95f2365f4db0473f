#include "alidade/features/subset.h"

namespace alidade {

Frame KeypointSubset(const Frame& frame, std::span<const int> kept, const Camera& camera) {
  Frame subset;
  subset.time = frame.time;
  subset.number = frame.number;
  subset.image = frame.image;
  subset.pyramid = frame.pyramid;
  subset.picture = frame.picture;
  subset.motion = frame.motion;
  subset.nearest = frame.nearest;
  for (int k : kept) {
    subset.keypoints.push_back(frame.keypoints[k]);
    subset.descriptors.push_back(frame.descriptors[k]);
    if (!frame.static_probability.empty())
      subset.static_probability.push_back(frame.static_probability[k]);
  }
  subset.grid = KeypointGrid(subset.keypoints, camera.width, camera.height);
  return subset;
}

}  // namespace alidade
