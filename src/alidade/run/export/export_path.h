// `alidade export` and Python's Result.export: converts a map or a run to formats of other
// programs.
#pragma once

#include <string>

#include "alidade/run/export/map_files.h"
#include "alidade/run/export/training_images.h"

namespace alidade {

// `path`: a map.alidade, a result folder, or (mcap) a recorded stream. mcap contains the whole run
// if it was recorded; the other formats contain the map of a folder. Folders of images read the
// recording again and call `progress`. Returns a description of what was written. Throws Error:
// usage for impossible requests, input for files that cannot be read or written; ExportStopped.
std::string ExportPath(const std::string& path, const ExportSettings& settings,
                       const std::string& out, const ExportProgress& progress = {});

// As ExportMap(), of a map moved as `settings` say (scale_by, up). Throws Error.
std::string ExportSaved(SavedMap saved, const ExportSettings& settings, const std::string& out);

}  // namespace alidade
