#include "alidade/serve/viewer_server.h"

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "alidade/base/error.h"
#include "alidade/base/module/load_module.h"
#include "alidade/serve/serve_module.h"
#include "alidade/version.h"

namespace alidade {
namespace {

struct ServeModule {
  ServeStartFunction* start = nullptr;
  std::string problem;
};

const ServeModule& TheServeModule() {
  static const ServeModule module = [] {
    const LoadedModule loaded = LoadModule(kServeModuleFile, {kServeModuleStart});
    if (loaded.symbols.empty()) return ServeModule{nullptr, loaded.problem};
    return ServeModule{reinterpret_cast<ServeStartFunction*>(loaded.symbols[0]), {}};
  }();
  return module;
}

void CheckReplay(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) ThrowInput(path + ": there is no such file");
  if (!std::ifstream(path, std::ios::binary)) ThrowInput(path + " cannot be read");
}

}  // namespace

void ServeSettings::Check() const {
  const auto check = [](bool good, const char* name, const char* range) {
    if (!good) ThrowUsage("serve." + std::string(name) + " must be " + range);
  };
  check(!host.empty(), "host", "an address of this machine, such as 127.0.0.1 or 0.0.0.0");
  check(port >= 0 && port <= 65535, "port", "within 0…65535");
  check(max_clients >= 1 && max_clients <= 10000, "max_clients", "within 1…10000");
  check(max_connections > max_clients && max_connections <= 100000, "max_connections",
        "above max_clients, 100000 at most");
  check(client_bytes >= 1024, "client_bytes", "at least 1024");
  check(patience >= 0.1 && patience <= 3600, "patience", "within 0.1…3600");
}

std::unique_ptr<ViewerServer> StartViewer(const ServeSettings& settings, StreamHub* hub,
                                          const std::string& replay_path,
                                          const std::string& title) {
  settings.Check();
  if (hub == nullptr) CheckReplay(replay_path);
  const nlohmann::json info = {{"mode", hub != nullptr ? "live" : "replay"},
                               {"title", title},
                               {"program", "alidade " ALIDADE_VERSION}};
  const ServeModule& module = TheServeModule();
  if (module.start == nullptr) {
    ThrowUsage("the viewer needs " + std::string(kServeModuleFile) +
               ", which is built where Boost (Debian: libboost-dev) is found: " + module.problem);
  }
  ServeTask task{settings, hub, hub == nullptr ? replay_path : "", ""};
  task.info = info.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string problem;
  std::unique_ptr<ViewerServer> server(module.start(task, &problem));
  if (!server) ThrowUsage("the viewer cannot be served: " + problem);
  return server;
}

}  // namespace alidade
