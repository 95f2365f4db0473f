// Size of the active map, from a sample of it. Uses medians, because some landmarks are far off.
#pragma once

#include "alidade/stream/stream_scene.h"

namespace alidade::gles {

// Median distance of landmarks to their keyframes, world units. Quantized to steps of 1/8 of a
// power of two, so that drawn sizes stay constant while the map grows; 1 without landmarks.
double TypicalDistance(const StreamScene& scene);

struct Extent {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 1;  // world units; contains all keyframes and 90 % of all sampled points
};
Extent ExtentOf(const StreamScene& scene);

}  // namespace alidade::gles
