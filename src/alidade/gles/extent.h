// How large the map is that the camera is in, from a sample of it: medians, as a few landmarks are
// always far off.
#pragma once

#include "alidade/stream/stream_scene.h"

namespace alidade::gles {

// Median distance of landmarks from their keyframes, world units, in steps of an eighth of a power
// of two, so that sizes stay as they are while the map grows; 1 while there are none.
double TypicalDistance(const StreamScene& scene);

struct Extent {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 1;  // world units: around all keyframes and nine tenths of the landmarks
};
Extent ExtentOf(const StreamScene& scene);

}  // namespace alidade::gles
