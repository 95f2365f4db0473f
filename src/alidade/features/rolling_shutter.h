// Rolling-shutter correction of keypoints.
#pragma once

#include <span>

#include "alidade/base/api.h"
#include "alidade/features/frame.h"
#include "alidade/geometry/camera.h"

namespace ALIDADE_API alidade {

// Moves each keypoint to where it would be observed if the whole image were read at its middle, and
// sets Frame::motion to `motion`. With s the readout time of the keypoint's row relative to the
// middle (seconds), m its undistorted direction (z = 1) and w its inverse depth, the corrected
// position is the projection of R m + w t, where (R, t) = Exp(-s motion). This is the
// constant-velocity model of Hedborg et al. 2012 (Rolling Shutter Bundle Adjustment), applied to
// the measurements instead of the camera. `inverse_depths`: one per keypoint, 1 / map units;
// `common` replaces unknown ones (<= 0). Starts from the raw positions, so it can be repeated with
// a better motion. No effect for a global shutter.
void UndoRollingShutter(const Camera& camera, const Vector6d& motion,
                        std::span<const float> inverse_depths, double common, Frame& frame);

}  // namespace alidade
