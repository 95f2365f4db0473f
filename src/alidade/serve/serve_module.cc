#include "alidade/serve/serve_module.h"

#include <exception>

#include "alidade/serve/server.h"

using alidade::Server;
using alidade::ServeTask;
using alidade::ViewerServer;

extern "C" __attribute__((visibility("default"))) ViewerServer* alidade_serve_start(
    const ServeTask& task, std::string* problem) try {
  return std::make_unique<Server>(task).release();
} catch (const std::exception& error) {
  *problem = error.what();
  return nullptr;
} catch (...) {
  *problem = "unknown reason";
  return nullptr;
}
