#include "viewer_flags.h"

#include "alidade/base/error.h"
#include "alidade/io/text.h"

namespace alidade {

ServeSettings ServeSettingsFor(const std::optional<std::string>& port,
                               const std::optional<std::string>& host) {
  ServeSettings settings;
  if (host) settings.host = *host;
  if (port && !port->empty()) {
    const std::optional<double> number = ParseNumber(*port);
    if (!number || *number != static_cast<int>(*number) || *number < 0 || *number > 65535)
      ThrowUsage("the viewer's port must be a number from 0 (any free port) to 65535, not '" +
                 *port + "'");
    settings.port = static_cast<int>(*number);
    settings.port_given = true;
  }
  settings.Check();
  return settings;
}

void AddAddressOptions(CLI::App& command, std::optional<std::string>& port,
                       std::optional<std::string>& host) {
  command.add_option("--port", port, "Port to listen on; default: 8090, or the next free one")
      ->type_name("PORT");
  command
      .add_option("--host", host,
                  "Address to listen on; default: 127.0.0.1, reachable from this machine only; "
                  "0.0.0.0: all addresses. Other machines need the secret in the printed address")
      ->type_name("ADDRESS");
}

}  // namespace alidade
