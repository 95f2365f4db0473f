// Renders a point cloud as an image: perspective projection, occlusion by depth, the camera's path
// on top.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "alidade/geometry/se3.h"
#include "alidade/io/cloud.h"

namespace alidade {

// All in one world frame and unit.
struct CloudScene {
  Cloud cloud;
  std::vector<std::vector<Se3>> path;  // T_world_camera; one list per uninterrupted stretch
  std::optional<Eigen::Vector3d> gravity =
      {};  // unit vector in which things fall; nullopt: unknown
};

enum class CloudView {
  kBehind,  // from behind and above the first camera
  kFront,   // along the first camera's viewing direction, from further back
  kSide,    // from the first camera's right
  kAbove    // from above; the first camera's forward direction is up in the image
};

struct CloudPictureSettings {
  int width = 1200, height = 800;  // pixels
  double field_of_view = 45;       // degrees, horizontal
  // Of the points, at either end of each axis, need not be in the picture: some always lie far off.
  double least_percent = 3;
  // Points known worse than this share of the distance they are seen from are left out: a haze
  // around what is there.
  double most_sigma = 0.01;
};

// Returns CV_8UC3, blue green red. The viewpoint is chosen so that the image contains the path and
// most points. The dots' size follows their density. Points have their colors, or gray without.
// Points that were seen from the other side only are omitted, so that walls do not hide the
// interior. An empty scene gives an empty image.
cv::Mat DrawCloud(const CloudScene& scene, CloudView view,
                  const CloudPictureSettings& settings = {});

}  // namespace alidade
