// `alidade export`: a map into files that other programs read.
#pragma once

#include <string>

#include "alidade/run/sources/saved_map.h"

namespace alidade {

struct ExportSettings {
  // ply, pcd: the landmarks; tum: the keyframes; colmap: both; mcap: both, as ROS 2 messages
  std::string to;
  std::string format = "default";  // text, binary, both (colmap only)
  int part = 0;                    // 0: the largest of the maps in the file
  int min_observations = 1;        // landmarks fewer keyframes see are left out
  void Check() const;              // throws Error (usage) for words that cannot be
};

// The map that is asked for, with the landmarks that are seen often enough. Throws Error (usage)
// for a part that is not there.
MapPart PartFor(const SavedMap& saved, const ExportSettings& settings);

// Writes `out`: a file, or for colmap a folder (export_folder.h). What was written, in words
// ("3071 points"). Throws Error: usage for a part that is not there, input for what cannot be
// written.
std::string ExportMap(const SavedMap& saved, const ExportSettings& settings,
                      const std::string& out);

}  // namespace alidade
