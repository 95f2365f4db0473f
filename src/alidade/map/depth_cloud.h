// The depth of keyframes as a cloud in the world, and as pictures.
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
  double scale = 1;  // lengths are those of `depth` times this
};

// Where the depth of a keyframe lies now. It must have one, and live as long as what comes back.
PlacedDepth PlaceDepth(const KeyFrame& keyframe);

// Every pixel as a point, with its colour and its sigma along the ray. With `voxel` > 0 (metres)
// all that fall into one cube of that edge (its corner at a multiple of it) become one point: the
// mean by inverse variance, whose sigma is that of a mean of independent errors. Points come in the
// order in which their cubes are first met.
Cloud MakeDepthCloud(const std::vector<PlacedDepth>& keyframes, const Camera& camera, double voxel);

inline constexpr double kDepthPictureFactor = 5000;  // per metre (map unit), as TUM's depth images

// CV_16U of the camera's size, kDepthPictureFactor per metre, 0 = not known or beyond 13.1 m;
// registered to the image as taken, lens distortion and all. Where two pixels of `depth` fall on
// one, the nearer holds.
cv::Mat DrawDepth(const DepthMap& depth, double scale, const Camera& camera);

}  // namespace alidade
