// Parses the viewer's options of `run` and `view`.
#pragma once

#include <optional>
#include <string>

#include "alidade/serve/viewer_server.h"

namespace alidade {

// `port`: as typed; empty or nullopt: 8090, or the next free one. Throws Error (usage).
ServeSettings ServeSettingsFor(const std::optional<std::string>& port,
                               const std::optional<std::string>& host);

}  // namespace alidade
