// The results of a finished run as plain values, from which its files are written.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "alidade/map/map_store.h"
#include "alidade/run/results/run_log.h"
#include "alidade/semidense/semidense_mapper.h"
#include "alidade/system/slam.h"

namespace alidade {

// One map and the frames located in it. Poses are T_world_camera of the (left) camera as mounted;
// `world` is that of the map's first keyframe.
struct MapResults {
  MapId id;
  Trajectory trajectory, live, keyframes;
  std::vector<KeyFrameId> keyframe_ids;  // one for each of `keyframes`
  bool meters = false;  // lengths are meters although the sensor alone does not tell (MapWorld)
  std::optional<Eigen::Vector3d> gravity = {};  // unit vector in `world`; nullopt: unknown
};

struct RunResults {
  std::vector<FramePose> frames;  // all frames that Track() processed
  MapSnapshot map;
  StageTimes times;
  SlamCounts counts;
  SemiDenseReport semidense;
  // What is told of the largest map; the gravity is turned into its written world.
  InertialReport inertial;
  int tracked = 0;  // frames, in all maps

  std::optional<int> initialized_at;              // number of the first tracked frame
  std::vector<std::array<double, 2>> lost_spans;  // seconds; not before the start
  std::vector<MapResults> maps;                   // most frames first; at least one, perhaps empty
  Eigen::Matrix3d R_camera_rectified;             // turns the map's points into that world
};

// A pose of the rectified camera as one of the camera as mounted, with the world turned likewise.
Se3 Mounted(const Se3& T_world_camera, const Eigen::Matrix3d& R_camera_rectified);

// `R_camera_rectified`: SourceInfo's.
RunResults ResultsOf(const Slam& slam, const RunLog& log,
                     const Eigen::Matrix3d& R_camera_rectified);

// The trajectory of the camera in one of the maps: T_world_camera, one list for each stretch
// without a gap.
std::vector<std::vector<Se3>> PathOf(const RunResults& results, size_t number = 0);

// "twice, 1.30 s in all".
std::string LostInAll(const std::vector<std::array<double, 2>>& spans);

double PathLength(const Trajectory& trajectory);  // in the unit of the trajectory

}  // namespace alidade
