// A cloud of points as a picture: perspective, points hide what is behind them, the camera's path
// drawn over it.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "alidade/geometry/se3.h"
#include "alidade/io/cloud.h"

namespace alidade {

// All in one world frame and unit.
struct CloudScene {
  Cloud cloud;
  std::vector<std::vector<Se3>> path;  // T_world_camera; one list for each stretch without a gap
};

enum class CloudView {
  kBehind,  // from behind and above the first camera
  kFront,   // as the first camera looked, from further back
  kSide,    // from its right
  kAbove    // from above, the direction in which it looked up on the page
};

struct CloudPictureSettings {
  int width = 1200, height = 800;  // pixels
  double field_of_view = 45;       // degrees, horizontal
  double least_percent = 3;        // of the points, at either end of each axis, need not be in the
                                   // picture: some always lie far off
  double most_sigma = 0.01;  // points known worse than this share of the distance they are seen
                             // from are left out: a haze around what is there
};

// CV_8UC3, blue green red. The viewpoint is chosen so that the path and most points are in the
// picture; the size of the dots follows how densely they lie. Points are seen in their colours,
// grey without. Like a doll's house the place is open to us: surfaces that were seen from their
// other side only are left out. An empty scene gives an empty picture.
cv::Mat DrawCloud(const CloudScene& scene, CloudView view,
                  const CloudPictureSettings& settings = {});

}  // namespace alidade
