// Trajectories and truth from files of any known format.
#pragma once

#include <string>

#include "alidade/base/api.h"
#include "alidade/io/trajectory.h"

namespace ALIDADE_API alidade {

// Known by its content: TUM text (8 numbers a line), EuRoC's ground truth csv (of the body: T_BS of
// ../cam0/sensor.yaml takes it to the left camera), KITTI poses (12 numbers a line, with times.txt
// beside them or in the sequence's folder). A folder stands for the truth in it: groundtruth.txt,
// mav0/state_groundtruth_estimate0/data.csv or poses.txt, or, of a folder of results,
// trajectory.txt. Throws Error (input), with file:line where there is one.
Trajectory ReadTrajectory(const std::string& path);

// The same for what is to be judged: a folder of results stands for its trajectory.txt, even where
// the truth lies beside it.
Trajectory ReadEstimate(const std::string& path);

}  // namespace alidade
