// `alidade export` and Python's Result.export: a map or a run into what other programs read.
#pragma once

#include <string>

#include "alidade/run/export/map_files.h"

namespace alidade {

// `path`: a map.alidade, a folder of results, or (mcap) a recorded stream. A folder's run is told
// as it was where it was recorded; of everything but mcap it is its map that is written. What was
// written, in words. Throws Error: usage for what cannot be asked of it, input for what cannot be
// read or written.
std::string ExportPath(const std::string& path, const ExportSettings& settings,
                       const std::string& out);

}  // namespace alidade
