// A result without a recorded stream, as messages of one (stream.fbs): the map, and the trajectory
// beside it.
#pragma once

#include <string>
#include <vector>

#include "alidade/run/sources/saved_map.h"

namespace alidade {

struct ResultStream {
  std::vector<std::string> messages;
  std::string cloud, mesh;  // paths of semidense.ply and mesh.ply; empty: none
  // From the world of the files to that of the map; differs from the identity for stereo pairs that
  // were rectified.
  Se3 T_map_files;
};

// `path`: the map file, or a result folder, whose trajectories and semi-dense cloud are used.
ResultStream StreamOfResult(const SavedMap& saved, const std::string& path);

}  // namespace alidade
