// Finds distortion polynomials that fold inside the image.
#pragma once

#include <optional>

#include "alidade/geometry/raw_camera.h"

namespace alidade {

// Distance from the principal point, pixels, of the closest point of the image beyond which the
// lens model maps two directions to one pixel: there the Jacobian determinant of ideal to distorted
// position is no longer positive. nullopt: the model is invertible in the whole image. For a
// fisheye only directions in front of the camera (θ < 90°) count, because images are rectified to a
// pinhole.
std::optional<double> FoldRadius(const RawCamera& camera);

}  // namespace alidade
