// Covariance of a pose by what it moves when parts of the image are left out.
#pragma once

#include "alidade/geometry/camera.h"
#include "alidade/map/map_store.h"
#include "alidade/map/measurement.h"
#include "alidade/tracking/placed_frame.h"

namespace alidade {

// A few wrong matches near the camera can hold a pose that the rest of a distant scene tells badly.
// They agree with the pose, so that residuals do not tell it. They are often side by side: on one
// object. The delete-a-group jackknife (Efron & Stein 1981; Shao & Tu 1995, §2.3) estimates the
// pose again without the matches of a twelfth of the image, for each of the G parts that have
// matches. With x_g the increment from the pose to that estimate:
//   covariance = (G - 1) / G sum of x_g x_g^T.
// Of the left increment of T_camera_world, as PoseOnlyResult::covariance. With few parts it is
// singular. Zero: fewer than two parts.
Matrix6d PartErrors(const PlacedFrame& placed, const Camera& camera, const MapSnapshot& map,
                    const MeasurementNoise& noise);

}  // namespace alidade
