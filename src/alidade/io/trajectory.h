// Trajectories as lists of stamped poses, and the text formats they are kept in.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "alidade/geometry/se3.h"

namespace alidade {

struct StampedPose {
  double time = 0;      // seconds
  Se3 T_world_camera;
  std::string stamp;    // the time as text where it is to be kept verbatim; empty: written with 9 digits
};
using Trajectory = std::vector<StampedPose>;

// TUM format: `timestamp tx ty tz qx qy qz qw`, # comments. `name` is used in errors (file:line).
Trajectory ParseTumTrajectory(std::string_view text, const std::string& name);
std::string FormatTumTrajectory(const Trajectory& trajectory);

}  // namespace alidade
