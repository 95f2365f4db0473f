// Trajectories as lists of stamped poses, and the text formats they are kept in.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/geometry/se3.h"

namespace ALIDADE_API alidade {

struct StampedPose {
  double time = 0;  // seconds
  Se3 T_world_camera;
  std::string
      stamp;  // the time as text where it is to be kept verbatim; empty: written with 9 digits
};
using Trajectory = std::vector<StampedPose>;

// In all of them `name` is used in errors (file:line); what is not a finite number, not a unit
// quaternion (to 5 %) or not a rotation throws Error. The order is the file's.

// TUM format: `timestamp tx ty tz qx qy qz qw`, # comments.
Trajectory ParseTumTrajectory(std::string_view text, const std::string& name);
std::string FormatTumTrajectory(const Trajectory& trajectory);

// EuRoC's state_groundtruth csv: nanoseconds, position, quaternion (w first) of the body; more
// columns are ignored.
Trajectory ParseEurocTrajectory(std::string_view text, const std::string& name,
                                const Se3& T_body_camera);

// KITTI odometry: one row-major 3x4 [R t] per line, and the times of the same lines from another
// file.
Trajectory ParseKittiTrajectory(std::string_view poses, const std::string& poses_name,
                                std::string_view times, const std::string& times_name);

// "1403715273262142976" -> "1403715273.262142976". What is not all digits comes back as it is.
std::string StampFromNanoseconds(std::string_view nanoseconds);

std::string FormatTime(double seconds);  // 9 digits after the point

}  // namespace alidade
