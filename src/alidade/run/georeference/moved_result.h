// Writes a result whose maps were aligned as a new result folder.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "alidade/run/georeference/aligned_map.h"

namespace alidade {

// `saved` and `maps` (the aligned ones, at least one): of the result folder `from`. `about`: what
// stats.json says of it as `georeference`. `facts`: lines for the report. Throws Error (input).
void WriteMovedResult(const std::string& from, const std::string& out, const SavedMap& saved,
                      const std::vector<AlignedMap>& maps, const nlohmann::ordered_json& about,
                      const std::vector<std::string>& facts);

}  // namespace alidade
