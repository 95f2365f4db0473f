// How well the keyframes of a map are known.
#pragma once

#include <utility>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/geometry/camera.h"
#include "alidade/map/map_store.h"
#include "alidade/map/measurement.h"

namespace ALIDADE_API alidade {

// Covariance of the pose of each keyframe of `map` after the map was aligned with the truth as a
// whole: T_world_camera * Exp(xi) is the true pose, xi = (translation; rotation) ~ N(0,
// covariance); m², m rad, rad² (one camera: map units). From the information of all observations,
// all keyframes and landmarks being unknown (CameraCovariances). In a map that is too large for
// that, a keyframe stands for two, four, … that were made after one another, with so much more
// information. By id; keyframes whose pose is not determined are left out.
std::vector<std::pair<KeyFrameId, Matrix6d>> KeyFrameCovariances(const MapSnapshot& snapshot,
                                                                 MapId map, const Camera& camera,
                                                                 const MeasurementNoise& noise);

}  // namespace alidade
