// Interface of libalidade_serve.so: the server of viewer_server.h, implemented with Boost.Beast,
// with the page's files compiled in. viewer_server.cc loads it on first use; no target links it.
// The program and the module are built together, so the interface may use C++ types; only the
// function name is C. No exception leaves the module.
#pragma once

#include <string>

#include "alidade/serve/frame_host.h"
#include "alidade/serve/post_host.h"
#include "alidade/serve/viewer_server.h"

namespace alidade {

struct ServeTask {
  ServeSettings settings;    // already checked
  StreamHub* hub = nullptr;  // null: replay the file
  std::string replay_path;
  std::string cloud_path;       // semidense.ply of a map without its run; empty: none
  std::string mesh_path;        // mesh.ply likewise
  std::string info;             // JSON returned for /info.json
  bool phone = false;           // serve the phone page instead of the viewer
  std::string core_folder;      // folder of the WebAssembly core; empty: none
  FrameHost* frames = nullptr;  // processes images that pages send; null: not supported
  PostHost* posts = nullptr;    // serve the page that localizes pictures, and answer them
};

inline constexpr char kServeModuleFile[] = "libalidade_serve.so";
inline constexpr char kServeModuleStart[] = "alidade_serve_start";

// Returns null and sets `problem`, one line, on failure.
using ServeStartFunction = ViewerServer*(const ServeTask& task, std::string* problem);

}  // namespace alidade
