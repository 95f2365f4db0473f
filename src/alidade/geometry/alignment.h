// Least-squares rigid motion or similarity between two sets of corresponding points.
#pragma once

#include <Eigen/Core>
#include <span>

#include "alidade/base/api.h"
#include "alidade/geometry/se3.h"

namespace ALIDADE_API alidade {

// Returns T_target_source that minimizes sum |target_i - T * source_i|² (Umeyama 1991). The scale
// is 1 unless `with_scale`. Throws Error (input) if the sizes differ, there are fewer than 3 pairs,
// a coordinate is not finite, all points of a set coincide, or no scale fits.
Sim3 AlignPoints(std::span<const Eigen::Vector3d> target, std::span<const Eigen::Vector3d> source,
                 bool with_scale);

}  // namespace alidade
