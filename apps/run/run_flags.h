// The flags of `alidade run`, `alidade localize` and `alidade ros2`.
#pragma once

#include "alidade/run/setup/options.h"

namespace CLI {
class App;
}

namespace alidade {

// Adds the flags. Parsing fills `options`, which must outlive `command`.
void AddRunOptions(CLI::App& command, RunOptions& options);
// The same for `alidade ros2`: the source is ros2: by default.
void AddPublishedRunOptions(CLI::App& command, RunOptions& options);
// The same for `alidade localize`.
void AddLocalizeOptions(CLI::App& command, RunOptions& options);

}  // namespace alidade
