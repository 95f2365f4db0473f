// A finished run as plain values, for the files made of it.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "alidade/map/map_store.h"
#include "run_record.h"

namespace alidade {

struct RunResults {
  std::vector<FramePose> frames;  // every one that Track() took
  MapSnapshot map;
  StageTimes times;
  int relocalisations = 0;

  std::optional<int> initialised_at;              // number of the first tracked frame
  std::vector<std::array<double, 2>> lost_spans;  // seconds; not before the start
  // Poses are T_world_camera of the (left) camera as mounted, `world` the first keyframe's.
  Trajectory trajectory, live, keyframes;
  Eigen::Matrix3d R_camera_rectified;  // turns the map's points into that world
};

RunResults ResultsOf(const Slam& slam, const RunRecord& record);

double PathLength(const Trajectory& trajectory);  // in the trajectory's unit

}  // namespace alidade
