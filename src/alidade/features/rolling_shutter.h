// Rolling shutters: rows are read one after another while the camera moves on.
#pragma once

#include <span>

#include "alidade/base/api.h"
#include "alidade/features/frame.h"
#include "alidade/geometry/camera.h"

namespace ALIDADE_API alidade {

// Puts each keypoint where it would have been seen had the whole image been read at its middle, and
// notes `motion` (see Frame::motion) as the frame's. With s the seconds between the reading of a
// keypoint's row and the middle, m its undistorted direction (z = 1) and w the inverse depth of
// what it shows, that is the projection of R m + w t with (R, t) = Exp(-s motion): the
// constant-velocity model of Hedborg et al. 2012 (Rolling Shutter Bundle Adjustment), applied to
// what was measured rather than to the camera. `inverse_depths`: one for each keypoint, 1 / map
// units; those not known
// (<= 0) are taken to be `common`. Works from the raw places: may be called again with a better
// motion. Does nothing to cameras that read all at once.
void UndoRollingShutter(const Camera& camera, const Vector6d& motion,
                        std::span<const float> inverse_depths, double common, Frame& frame);

}  // namespace alidade
