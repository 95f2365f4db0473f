// Which way is up in a world that a camera found.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "alidade/geometry/se3.h"

namespace alidade {

// Rows: right, forward and up, in world coordinates, orthonormal. Cameras are held without leaning,
// and upright, on average; forward is where the first one looked, as far as that is level. `path`
// is T_world_camera, in stretches; empty: as if of one camera, the world's own.
Eigen::Matrix3d UprightAxes(const std::vector<std::vector<Se3>>& path);

}  // namespace alidade
