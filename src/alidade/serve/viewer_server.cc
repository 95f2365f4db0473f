#include "alidade/serve/viewer_server.h"

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "alidade/base/error.h"
#include "alidade/base/module/load_module.h"
#include "alidade/serve/response.h"
#include "alidade/serve/serve_module.h"
#include "alidade/version.h"

namespace alidade {
namespace {

const LoadedFunction<ServeStartFunction>& TheServeModule() {
  static const auto module = LoadFunction<ServeStartFunction>(kServeModuleFile, kServeModuleStart);
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
  check(arrival >= 0.1 && arrival <= 3600, "arrival", "within 0.1…3600");
}

namespace {

std::unique_ptr<ViewerServer> Start(const ServeTask& task) {
  const auto& module = TheServeModule();
  if (module.call == nullptr) {
    ThrowUsage("the viewer needs " + std::string(kServeModuleFile) +
               ", which is built where Boost (Debian: libboost-dev) is found: " + module.problem);
  }
  std::string problem;
  std::unique_ptr<ViewerServer> server(module.call(task, &problem));
  if (!server) ThrowUsage("the page cannot be served: " + problem);
  return server;
}

std::string TextOf(const nlohmann::json& info) {
  return info.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

bool HasCore(const std::string& core_folder, const std::string& variant) {
  return !FindCore("/core/" + variant + "/alidade.wasm", core_folder).empty();
}

std::unique_ptr<ViewerServer> StartPhonePage(const ServeSettings& settings,
                                             const std::string& core_folder, FrameHost* frames) {
  settings.Check();
  const nlohmann::json info = {{"mode", "phone"},
                               {"connected", frames != nullptr},
                               {"core", HasCore(core_folder, "single")},
                               {"threads", HasCore(core_folder, "threads")},
                               {"program", "alidade " ALIDADE_VERSION}};
  ServeTask task;
  task.settings = settings;
  task.phone = true;
  task.core_folder = core_folder;
  task.frames = frames;
  task.info = TextOf(info);
  return Start(task);
}

std::unique_ptr<ViewerServer> StartPostPage(const ServeSettings& settings, const std::string& info,
                                            PostHost* posts) {
  settings.Check();
  ServeTask task;
  task.settings = settings;
  task.posts = posts;
  task.info = info;
  return Start(task);
}

std::unique_ptr<ViewerServer> StartViewer(const ServeSettings& settings, StreamHub* hub,
                                          const std::string& replay_path, const std::string& title,
                                          const StillMap* still) {
  settings.Check();
  if (hub == nullptr) CheckReplay(replay_path);
  nlohmann::json info = {{"mode", hub != nullptr ? "live" : "replay"},
                         {"title", title},
                         {"program", "alidade " ALIDADE_VERSION}};
  ServeTask task;
  task.settings = settings;
  task.hub = hub;
  if (hub == nullptr) task.replay_path = replay_path;
  if (still != nullptr) {
    info["mode"] = "map";
    task.cloud_path = still->cloud_path;
    task.mesh_path = still->mesh_path;
    if (!task.mesh_path.empty()) info["T_world_mesh"] = still->T_world_cloud;
    if (!task.cloud_path.empty()) info["T_world_cloud"] = still->T_world_cloud;
  }
  task.info = TextOf(info);
  return Start(task);
}

}  // namespace alidade
