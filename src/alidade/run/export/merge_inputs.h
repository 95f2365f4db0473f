// What `alidade merge` is given, and where its poses come to lie in the merged map.
#pragma once

#include <string>
#include <vector>

#include "alidade/io/trajectory.h"
#include "alidade/system/merge_maps.h"

namespace alidade {

// A trajectory of a recording, in one of the worlds.
struct Path {
  MapId world;
  Trajectory frames;  // keyframes, where nothing more is known
  bool keyframes_only = false;
};

struct MergeInput {
  std::string name;  // told apart: "monday", "tuesday", "monday-2"
  std::string path;  // as given: a map, or the folder `run` left
  SavedMap saved;
  // Turns the map's world into that of the trajectories: those of pairs and fisheyes are told in
  // the camera as it is mounted, maps in the rectified one.
  Eigen::Matrix3d R_camera_rectified = Eigen::Matrix3d::Identity();
  std::vector<Path> paths;  // in the input's own worlds; ids of `saved`
};

// Throws Error: usage for fewer than two, input, beginning with the path, for what is no map.
std::vector<MergeInput> ReadMergeInputs(const std::vector<std::string>& paths);

// The paths of one input in the merged worlds: a frame goes with the keyframes before and after it,
// by as much as each is nearer in time; lengths grow as theirs (mono).
std::vector<Path> MovedPaths(const MergeInput& input, const UnitedPart& part,
                             const MapSnapshot& merged);

}  // namespace alidade
