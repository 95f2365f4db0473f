// Search for a known descriptor near its expected position.
#pragma once

#include <vector>

#include "alidade/features/frame.h"

namespace alidade {

struct Sought {
  const Descriptor* descriptor = nullptr;
  float x = 0, y = 0;  // expected position, undistorted pixels
  // Expected column in the right image; kNoDepth: not checked.
  float right_x = Keypoint::kNoDepth;
  float radius = 0;                                   // search radius, pixels
  int min_level = 0, max_level = kPyramidLevels - 1;  // admissible pyramid levels
};

struct Sighting {
  int keypoint = -1;   // index in the frame; -1: none found
  int distance = 256;  // of the best match, bits
  // Distance and pyramid level of the second-best match.
  int second_distance = 256;
  int level = -1, second_level = -1;
};

// Best match for `sought` among the keypoints of `frame` for which is_free(index) is true. On a tie
// the first keypoint in grid order wins.
template <typename IsFree>
Sighting FindNear(const Frame& frame, const Sought& sought, IsFree&& is_free) {
  Sighting found;
  frame.grid.VisitNear(sought.x, sought.y, sought.radius, [&](int i) {
    const Keypoint& keypoint = frame.keypoints[i];
    if (keypoint.level < sought.min_level || keypoint.level > sought.max_level) return;
    if (std::abs(keypoint.x - sought.x) > sought.radius ||
        std::abs(keypoint.y - sought.y) > sought.radius)
      return;
    if (sought.right_x >= 0 && keypoint.right_x >= 0 &&
        std::abs(keypoint.right_x - sought.right_x) > sought.radius)
      return;
    if (!is_free(i)) return;
    const int distance = HammingDistance(*sought.descriptor, frame.descriptors[i]);
    if (distance < found.distance) {
      found.second_distance = found.distance;
      found.second_level = found.level;
      found.distance = distance;
      found.level = keypoint.level;
      found.keypoint = i;
    } else if (distance < found.second_distance) {
      found.second_distance = distance;
      found.second_level = keypoint.level;
    }
  });
  return found;
}

// Pyramid level at which a landmark is expected at `distance`; `max_distance` is the largest
// distance at which it can be observed on level 0. ceil(log(max_distance / distance) / log 1.2),
// clamped to the valid levels (Mur-Artal, Montiel & Tardós 2015).
int PredictLevel(double max_distance, double distance);

}  // namespace alidade
