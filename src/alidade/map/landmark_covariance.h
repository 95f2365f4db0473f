// How well the position of a landmark is known.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "alidade/base/api.h"
#include "alidade/geometry/camera.h"
#include "alidade/map/map_store.h"
#include "alidade/map/measurement.h"

namespace ALIDADE_API alidade {

// Covariance of the landmark's position in the world, m² (one camera: map units²): the inverse of
// the sum of Jᵀ Λ J over its observations, J the derivative of the pixel by the position. The
// keyframes are taken as exact, so errors that they have in common (drift, scale) are not in it.
// nullopt: no such landmark, or its depth is not determined (Landmark::depth_assumed, or fewer than
// two observations).
std::optional<Eigen::Matrix3d> LandmarkCovariance(const MapSnapshot& map, LandmarkId id,
                                                  const Camera& camera,
                                                  const MeasurementNoise& noise = {});

}  // namespace alidade
