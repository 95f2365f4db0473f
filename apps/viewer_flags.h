// Options of the commands that serve pages.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "alidade/serve/viewer_server.h"

namespace alidade {

// `port`: as typed; empty or nullopt: 8090, or the next free one. Throws Error (usage).
ServeSettings ServeSettingsFor(const std::optional<std::string>& port,
                               const std::optional<std::string>& host);

// --port and --host of `view`, `phone` and `serve`.
void AddAddressOptions(CLI::App& command, std::optional<std::string>& port,
                       std::optional<std::string>& host);

}  // namespace alidade
