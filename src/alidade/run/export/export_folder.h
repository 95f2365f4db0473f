// Writes a folder with an exported model completely or not at all.
#pragma once

#include <string>
#include <vector>

#include "alidade/io/colmap.h"

namespace alidade {

// Writes the files, and export.json as a marker, into a temporary folder next to `path`, then
// renames that to `path`. An existing `path` must be empty or an earlier export without other
// files. Throws Error (input) otherwise, and if writing fails; nothing new remains then.
void WriteExportFolder(const std::string& path, const std::vector<ColmapFile>& files);

}  // namespace alidade
