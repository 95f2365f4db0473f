// Serves the viewer's page and the stream of a run, live or recorded, to browsers. What does it is
// a module of its own (serve_module.h), loaded when it is first asked for.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "alidade/serve/frame_host.h"
#include "alidade/stream/stream_hub.h"

namespace alidade {

struct ServeSettings {
  // An address of this machine, or a name of one: whom it can be reached from. Beyond loopback a
  // token is asked for, which address() holds.
  std::string host = "127.0.0.1";
  int port = 8090;          // 0: any free one
  bool port_given = false;  // by the user: taken as it is; else the next free one will do as well
  // Viewers at a time: each costs at most the whole state and `client_bytes`.
  int max_clients = 64;
  // Sockets at a time, viewers included; beyond, the one that has been silent longest is closed.
  // Leaves three quarters of the usual 1024 descriptors to the run.
  int max_connections = 256;
  // What waits for a viewer at most, besides the state it began with: 2 s of the stream with
  // pictures. Who falls behind further is given the whole state instead.
  size_t client_bytes = size_t{4} << 20;
  // Seconds in which a request must have come, a part of a file must have been taken, and a viewer
  // must have given some sign of life (it is asked for one after half of that).
  double patience = 10;
  bool tls = false;    // https, with a certificate made on the spot
  void Check() const;  // throws Error (usage) naming the field that cannot be
};

// Ends when destroyed, within 2 seconds, in which viewers are sent what waits for them.
class ViewerServer {
 public:
  virtual ~ViewerServer() = default;
  // What to open: http://127.0.0.1:8090/, with ?token=… when one is needed.
  virtual const std::string& address() const = 0;
  virtual int port() const = 0;
  virtual int viewers() const = 0;    // who are connected to the live stream now
  virtual bool has_page() const = 0;  // false: built without Node.js, a plain page says so
  // SHA-256 of the certificate, as browsers show it; empty without TLS.
  virtual const std::string& fingerprint() const = 0;
};

// Live when there is a `hub`, which must outlive the server; else the recorded stream in the file
// `replay_path`. Throws Error when it cannot be: the module is missing, the port is in use, the
// file cannot be read. Returns once connections are taken.
std::unique_ptr<ViewerServer> StartViewer(const ServeSettings& settings, StreamHub* hub,
                                          const std::string& replay_path, const std::string& title);

// The page for phones. `core_folder`: where the core as WebAssembly is (scripts/wasm/build:
// build-wasm); empty: nowhere. `frames`, which must outlive the server: who works on pictures that
// pages send; null: nobody does.
std::unique_ptr<ViewerServer> StartPhonePage(const ServeSettings& settings,
                                             const std::string& core_folder, FrameHost* frames);
// Which variants of the core are in a folder: "single", "threads".
bool HasCore(const std::string& core_folder, const std::string& variant);

}  // namespace alidade
