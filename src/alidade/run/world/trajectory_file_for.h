// Which of a result's trajectory files is of a map.
#pragma once

#include <string>

#include "alidade/run/sources/saved_map.h"

namespace alidade {

// The file in a result folder with the trajectory of a map: the one beside the list of keyframes
// that has most of the map's. Empty: none.
std::string TrajectoryFileFor(const SavedMap& saved, const MapPart& part,
                              const std::string& folder);

}  // namespace alidade
