// The inputs of `alidade merge`, and their poses in the merged map.
#pragma once

#include <string>
#include <vector>

#include "alidade/io/trajectory.h"
#include "alidade/system/merge_maps.h"

namespace alidade {

// A trajectory of a recording, in one of the world frames.
struct Path {
  MapId world;
  Trajectory frames;  // keyframes, if only those are known
  bool keyframes_only = false;
};

struct MergeInput {
  std::string name;  // unique: "monday", "tuesday", "monday-2"
  std::string path;  // as given: a map or a result folder of `run`
  SavedMap saved;
  // Rotation from the map's world to that of the trajectories. Trajectories of stereo pairs and
  // fisheye cameras refer to the camera as mounted, maps to the rectified camera.
  Eigen::Matrix3d R_camera_rectified = Eigen::Matrix3d::Identity();
  std::vector<Path> paths;  // in the input's own worlds; ids of `saved`
};

// Throws Error: usage for fewer than two inputs; input, beginning with the path, for an invalid
// map.
std::vector<MergeInput> ReadMergeInputs(const std::vector<std::string>& paths);

// The paths of one input in the merged worlds. The correction of a frame is interpolated between
// the keyframes before and after it by time, including the scale (monocular).
std::vector<Path> MovedPaths(const MergeInput& input, const UnitedPart& part,
                             const MapSnapshot& merged);

}  // namespace alidade
