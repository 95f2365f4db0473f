// How likely a point of the scene is to keep its place in the image while the camera moves.
#pragma once

#include <opencv2/core.hpp>
#include <span>

#include "alidade/features/frame.h"
#include "alidade/geometry/camera.h"

namespace alidade {

// A point of the scene keeps its place where the flow of the camera's motion is zero: at the focus
// of expansion, far away when the camera does not turn, at the point an orbit is centered on.
// Estimates the motion from the matches of two frames that moved by more than `tolerance` pixels.
// Each value of the result is the share of the matched points that would stay within `tolerance`
// pixels if they were seen there: P(stays | scene), CV_32F, one pixel per cell of `cell` pixels,
// raw image coordinates. A sixth of the weight is that of points at infinity. Empty if the points
// moved too little (a median of 2.5 `tolerance`), or if fewer than half of the matches agree on one
// motion.
cv::Mat ChanceToStay(const Camera& camera, const Frame& then, const Frame& now, int cell,
                     double tolerance);

}  // namespace alidade
