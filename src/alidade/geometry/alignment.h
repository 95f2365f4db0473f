// The rigid motion or similarity that lays one set of points on another, in least squares.
#pragma once

#include <Eigen/Core>
#include <span>

#include "alidade/base/api.h"
#include "alidade/geometry/se3.h"

namespace ALIDADE_API alidade {

// T minimising sum |target_i - T * source_i|² (Umeyama 1991; scale held at 1 unless asked for). At
// least 3 pairs, not all in one point: throws Error (input) otherwise, and on numbers that are not
// finite.
Sim3 AlignPoints(std::span<const Eigen::Vector3d> target, std::span<const Eigen::Vector3d> source,
                 bool with_scale);

}  // namespace alidade
