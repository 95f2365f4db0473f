// `alidade export`: writes a map to files for other programs.
#pragma once

#include <string>

#include "alidade/run/sources/saved_map.h"

namespace alidade {

struct ExportSettings {
  // ply, pcd: the landmarks; tum: the keyframes; colmap: both; mcap: both, as ROS 2 messages
  std::string to;
  std::string format = "default";  // text, binary, both (colmap only)
  int part = 0;                    // 0: the largest of the maps in the file
  int min_observations = 1;        // landmarks observed by fewer keyframes are omitted
  void Check() const;              // throws Error (usage) for unknown words
};

// The chosen map, with the landmarks that have enough observations. Throws Error (usage) for a part
// that does not exist.
MapPart PartFor(const SavedMap& saved, const ExportSettings& settings);

// Writes `out`: a file, or for colmap a folder (export_folder.h). Returns a description of what was
// written ("3071 points"). Throws Error: usage for a part that does not exist, input if writing
// fails.
std::string ExportMap(const SavedMap& saved, const ExportSettings& settings,
                      const std::string& out);

}  // namespace alidade
