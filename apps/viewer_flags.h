// The flags of a viewer, as `run` and `view` have them.
#pragma once

#include <optional>
#include <string>

#include "alidade/serve/viewer_server.h"

namespace alidade {

// `port`: as typed; empty or nothing: 8090, or the next that is free. Throws Error (usage).
ServeSettings ServeSettingsFor(const std::optional<std::string>& port,
                               const std::optional<std::string>& host);

}  // namespace alidade
