// Finding a known descriptor near the place where it should be seen.
#pragma once

#include <vector>

#include "alidade/features/frame.h"

namespace alidade {

struct Sought {
  const Descriptor* descriptor = nullptr;
  float x = 0, y = 0;                  // expected place, undistorted pixels
  float right_x = Keypoint::kNoDepth;  // expected column in the right image; kNoDepth = not checked
  float radius = 0;                    // pixels around it
  int min_level = 0, max_level = kPyramidLevels - 1;  // pyramid levels it may be found on
};

struct Sighting {
  int keypoint = -1;          // index in the frame; -1: nothing there
  int distance = 256;         // bits
  int second_distance = 256;  // next best keypoint there, and its level
  int level = -1, second_level = -1;
};

// Best keypoint of `frame` for `sought` among those `is_free` (called with an index) lets through.
// Ties go to the lower index within the grid's order.
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

// Pyramid level a landmark should be found on at `distance`, from the largest distance it could be
// seen at on level 0 upwards (ORB-SLAM: ceil(log(max_distance / distance) / log 1.2), clamped).
int PredictLevel(double max_distance, double distance);

}  // namespace alidade
