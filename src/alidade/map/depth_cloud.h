// Semi-dense depth of keyframes as a point cloud in the world frame, and as depth images.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/geometry/camera.h"
#include "alidade/io/cloud.h"
#include "alidade/map/map_store.h"

namespace ALIDADE_API alidade {

struct PlacedDepth {
  const DepthMap* depth = nullptr;
  Se3 T_world_camera;
  double scale = 1;  // lengths = those of `depth` × scale
};

// Current placement of a keyframe's depth. The keyframe must have a depth map and outlive the
// result.
PlacedDepth PlaceDepth(const KeyFrame& keyframe);

// One point per depth pixel, with color and sigma along the ray. If `voxel` > 0 (meters), all
// points in one cube with that edge length are merged into their inverse-variance weighted mean,
// whose sigma assumes independent errors. Points are in the order in which their cubes first occur.
Cloud MakeDepthCloud(const std::vector<PlacedDepth>& keyframes, const Camera& camera, double voxel);

inline constexpr double kDepthPictureFactor = 5000;  // per meter (map unit), as in TUM depth images

// CV_16U of the camera's size, kDepthPictureFactor per meter, 0 = unknown or beyond 13.1 m.
// Registered to the raw (distorted) image. The nearer of two points that fall on one pixel wins.
cv::Mat DrawDepth(const DepthMap& depth, double scale, const Camera& camera);

}  // namespace alidade
