// Results, recorded streams and maps as MCAP files.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "alidade/run/sources/saved_map.h"

namespace alidade {

struct McapCounts {
  int frames = 0;  // told one by one
  size_t landmarks = 0, shape = 0;
  size_t bytes = 0;
};

// Where the recorded stream of `path` lies: itself, or run.stream in that folder of results; empty:
// there is none.
std::string StreamIn(const std::string& path);

// A recorded stream, and what the run's files say of its end: of the folder it lies in, where that
// holds results. Throws Error (input) when one cannot be read, or `out` not be written.
McapCounts ExportStream(const std::string& stream, const std::string& out,
                        const std::string& program);

// A folder of results without a stream: poses of trajectory_live.txt frame by frame, the finished
// map and path with the first of them and at the end, the milliseconds of stats.json.
McapCounts ExportResults(const std::string& folder, const std::string& out,
                         const std::string& program);

// A map: its keyframes are the frames.
McapCounts ExportMapToMcap(const SavedMap& saved, const MapPart& part, const std::string& out,
                           const std::string& program);

}  // namespace alidade
