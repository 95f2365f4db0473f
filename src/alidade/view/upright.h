// Estimates the up direction of a world from the camera path.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "alidade/geometry/se3.h"

namespace alidade {

// Rows: right, forward and up in world coordinates, orthonormal. Assumes that on average cameras
// are held upright without roll. Forward is the horizontal part of the first camera's viewing
// direction. `path`: T_world_camera in stretches; when empty, the world's own axes are used as
// those of one camera. `gravity`: unit vector in which things fall, if it is known: then up is not
// estimated.
Eigen::Matrix3d UprightAxes(const std::vector<std::vector<Se3>>& path,
                            const std::optional<Eigen::Vector3d>& gravity = {});

}  // namespace alidade
