// Reads estimated and true trajectories from files of any supported format.
#pragma once

#include <string>

#include "alidade/base/api.h"
#include "alidade/io/trajectory.h"

namespace ALIDADE_API alidade {

// Detects the format from the content: TUM text (8 numbers per line), EuRoC's ground truth csv
// (body poses, converted to the left camera with T_BS of ../cam0/sensor.yaml), or KITTI poses (12
// numbers per line, with times.txt beside the file or in the sequence's folder). For a folder it
// reads the ground truth in it (groundtruth.txt, mav0/state_groundtruth_estimate0/data.csv or
// poses.txt), else trajectory.txt. Throws Error (input), with file:line where there is one.
Trajectory ReadTrajectory(const std::string& path);

// The same for an estimate: for a folder with a trajectory.txt it reads that file, even when ground
// truth is beside it.
Trajectory ReadEstimate(const std::string& path);

}  // namespace alidade
