// What libalidade_serve.so offers: the server of viewer_server.h, by Boost.Beast, with the page's
// files compiled in. Loaded by viewer_server.cc, linked by nobody. Both sides are built together:
// the interface may hold C++ types, only its name is C. No exception leaves the module.
#pragma once

#include <string>

#include "alidade/serve/frame_host.h"
#include "alidade/serve/viewer_server.h"

namespace alidade {

struct ServeTask {
  ServeSettings settings;    // checked
  StreamHub* hub = nullptr;  // null: the file
  std::string replay_path;
  std::string info;             // what /info.json answers
  bool phone = false;           // the page for phones, not the viewer's
  std::string core_folder;      // of the core as WebAssembly; empty: none
  FrameHost* frames = nullptr;  // who works on pictures that pages send; null: nobody
};

inline constexpr char kServeModuleFile[] = "libalidade_serve.so";
inline constexpr char kServeModuleStart[] = "alidade_serve_start";

// Null when it cannot be, and `problem` says why, in one line.
using ServeStartFunction = ViewerServer*(const ServeTask& task, std::string* problem);

}  // namespace alidade
