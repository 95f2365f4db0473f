// Settings from a YAML file.
#pragma once

#include <string>

#include "alidade/run/setup/run_settings.h"

namespace alidade {

// Sets the values of the file, whose names are nested (`tracker:` / `  min_tracked: 30`) or dotted
// (`tracker.min_tracked: 30`). Throws Error with file:line: kInput if it cannot be read or is not
// YAML, kUsage for an invalid name or value.
void ApplySettingsFile(const std::string& path, RunSettings& settings);
// The same for the text of a file; `name` appears in error messages.
void ApplySettingsText(const std::string& text, const std::string& name, RunSettings& settings);

}  // namespace alidade
