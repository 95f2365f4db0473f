// Results, recorded streams and maps as MCAP files.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "alidade/run/sources/saved_map.h"

namespace alidade {

struct McapCounts {
  int frames = 0;  // frames written individually
  size_t landmarks = 0, shape = 0;
  size_t bytes = 0;
};

// Path of the recorded stream of `path`: `path` itself, or run.stream in that result folder; empty:
// none.
std::string StreamIn(const std::string& path);

// Converts a recorded stream, and the final results if its folder contains any. Throws Error
// (input) if a file cannot be read, or `out` cannot be written.
McapCounts ExportStream(const std::string& stream, const std::string& out,
                        const std::string& program);

// Converts a result folder without a stream: poses of trajectory_live.txt frame by frame, the final
// map and path with the first frame and at the end, the processing times of stats.json.
McapCounts ExportResults(const std::string& folder, const std::string& out,
                         const std::string& program);

// Converts a map, with its keyframes as frames.
McapCounts ExportMapToMcap(const SavedMap& saved, const MapPart& part, const std::string& out,
                           const std::string& program);

}  // namespace alidade
