// A frame with its pose and the landmarks it shows: what tracking passes along.
#pragma once

#include <memory>
#include <vector>

#include "alidade/base/ids.h"
#include "alidade/features/frame.h"
#include "alidade/geometry/se3.h"

namespace alidade {

// A frame placed in the map.
struct PlacedFrame {
  std::shared_ptr<const Frame> frame;
  Se3 T_camera_world;
  std::vector<LandmarkId> matches;  // one for each keypoint; none where nothing is known
  int inliers = 0;                  // matches that agree with the pose
};

}  // namespace alidade
