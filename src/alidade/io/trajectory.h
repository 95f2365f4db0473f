// Trajectories as lists of stamped poses, and their text formats.
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
  // Time as text, written verbatim; empty: `time` is written with 9 decimals.
  std::string stamp;
};
using Trajectory = std::vector<StampedPose>;

// `name` appears in errors as file:line. The parsers throw Error (input) for a value that is not
// finite, a quaternion whose length is not 1 (within 5 %), or a matrix that is not a rotation.
// Poses keep the file's order.

// TUM format: `timestamp tx ty tz qx qy qz qw`, with # comments. Stamps too large to be seconds are
// read in the unit that ProbableUnit() finds.
Trajectory ParseTumTrajectory(std::string_view text, const std::string& name);
std::string FormatTumTrajectory(const Trajectory& trajectory);

// EuRoC's state_groundtruth csv: nanoseconds, position and quaternion (w first) of the body;
// further columns are ignored. `T_body_camera` converts body poses to camera poses.
Trajectory ParseEurocTrajectory(std::string_view text, const std::string& name,
                                const Se3& T_body_camera);

// KITTI odometry: a row-major 3x4 matrix [R t] per line in `poses`, and the time of the same line
// in `times`.
Trajectory ParseKittiTrajectory(std::string_view poses, const std::string& poses_name,
                                std::string_view times, const std::string& times_name);

std::string FormatTime(double seconds);  // 9 decimals

}  // namespace alidade
