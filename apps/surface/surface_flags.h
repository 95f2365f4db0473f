// What `alidade mesh` and `alidade grid` share: options, progress, the end.
#pragma once

#include <functional>
#include <string>

#include "alidade/run/surface/surface_files.h"

namespace CLI {
class App;
}

namespace alidade {

// RESULT, --out, --every, --part, --source, --camera.
void AddSurfaceOptions(CLI::App& command, std::string& path, std::string& out,
                       DenseViewSettings& views, const char* out_help);

// Runs `write` with a progress line and prints what it returns. Returns the exit status.
int RunSurfaceCommand(const std::function<std::string(const ExportProgress&)>& write);

}  // namespace alidade
