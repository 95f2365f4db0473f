// Trajectories for other programs.
#pragma once

#include <string>

#include "alidade/io/trajectory.h"
#include "alidade/run/export/map_files.h"

namespace alidade {

// KITTI odometry: the 12 numbers of [R t] by rows, one line per pose.
std::string FormatKittiTrajectory(const Trajectory& trajectory);
// EuRoC's ground truth: nanoseconds, position, quaternion (w first), of the camera.
std::string FormatEurocTrajectory(const Trajectory& trajectory);

// The trajectory in a world whose z axis is the mean of the camera's upright axis (-y), as an
// estimate of the vertical where gravity was not measured. Throws Error (input) if these axes have
// no common direction (their mean is shorter than 0.5).
Trajectory WithZUp(Trajectory trajectory);

// As --to and --up say.
std::string FormatTrajectory(Trajectory trajectory, const ExportSettings& settings);

// `path`: of a map or a result folder. Writes tum, evo, kitti or euroc and returns a description.
// `settings.poses`: "frames" of the result's trajectory of that part, "keyframes" of the map, or
// "default": frames where they are, but keyframes for tum. `T_now_written`: from the world of the
// trajectory files to that of `saved`, which was moved since. Throws Error.
std::string ExportTrajectory(const std::string& path, const SavedMap& saved,
                             const ExportSettings& settings, const Sim3& T_now_written,
                             const std::string& out);

}  // namespace alidade
