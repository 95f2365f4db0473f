// Reads map files for the commands that take one.
#pragma once

#include <string>
#include <vector>

#include "alidade/map/map_file.h"

namespace alidade {

// Reads `path`: a map file or a result folder of `run`. Throws Error (input), beginning with the
// path, if there is no valid map.
SavedMap ReadSavedMap(const std::string& path);
// Path of the map file: `path` itself, or map.alidade in that folder.
std::string SavedMapPath(const std::string& path);

// One of the maps in a file; each has its own world frame.
struct MapPart {
  std::vector<KeyFrameId> keyframes;  // by id
  std::vector<LandmarkId> landmarks;  // by id
};

// Sorted by keyframes, most first; equal ones by age, oldest first. Empty for an empty map.
std::vector<MapPart> PartsOf(const MapSnapshot& map);

}  // namespace alidade
