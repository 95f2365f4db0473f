// Maps as files, for the commands that are given one.
#pragma once

#include <string>
#include <vector>

#include "alidade/map/map_file.h"

namespace alidade {

// Reads `path`: a map, or the folder `run` left one in. Throws Error (input), beginning with the
// path, when there is none or it cannot be used.
SavedMap ReadSavedMap(const std::string& path);
// Where it lies: `path` itself, or map.alidade in that folder.
std::string SavedMapPath(const std::string& path);

// One of the maps in a file: each has a world of its own.
struct MapPart {
  std::vector<KeyFrameId> keyframes;  // by id
  std::vector<LandmarkId> landmarks;  // by id
};

// The one with the most keyframes first; of equals the older. None in an empty map.
std::vector<MapPart> PartsOf(const MapSnapshot& map);

}  // namespace alidade
