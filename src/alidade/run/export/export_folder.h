// A folder that holds an exported model: there whole, or not at all.
#pragma once

#include <string>
#include <vector>

#include "alidade/io/colmap.h"

namespace alidade {

// Writes the files, and export.json to know them by, into a new folder beside `path`, then renames
// that to `path`. What is there must be an empty folder or an earlier export, with nothing else in
// it. Throws Error (input) otherwise, and when something cannot be written: nothing new stays then.
void WriteExportFolder(const std::string& path, const std::vector<ColmapFile>& files);

}  // namespace alidade
