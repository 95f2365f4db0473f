// Settings from a YAML file.
#pragma once

#include <string>

#include "alidade/run/setup/run_settings.h"

namespace alidade {

// Sets what the file names, nested (`tracker:` / `  min_tracked: 30`) or dotted
// (`tracker.min_tracked: 30`). Throws Error with file:line: kInput when it cannot be read or is no
// YAML, kUsage for a name or value that cannot be.
void ApplySettingsFile(const std::string& path, RunSettings& settings);
// The same of a file's text; `name` is what it is called in errors.
void ApplySettingsText(const std::string& text, const std::string& name, RunSettings& settings);

}  // namespace alidade
