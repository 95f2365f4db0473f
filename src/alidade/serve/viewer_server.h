// Serves the viewer's page and a live or recorded stream to web browsers. The implementation is a
// module (serve_module.h), loaded on first use.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <string>

#include "alidade/serve/frame_host.h"
#include "alidade/serve/post_host.h"
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
  // Sockets at a time, viewers included; beyond, the one that has been silent longest is closed,
  // those without the token first. Leaves three quarters of the usual 1024 descriptors to the run.
  int max_connections = 256;
  // What waits for a viewer at most, besides the state it began with: 2 s of the stream with
  // pictures. Who falls behind further is given the whole state instead.
  size_t client_bytes = size_t{4} << 20;
  // Seconds in which a request must have come, a part of a file must have been taken, and a viewer
  // must have given some sign of life (it is asked for one after half of that).
  double patience = 10;
  // Seconds in which a new connection must have completed its TLS handshake, and again as many in
  // which it must have shown the token. Phones in a weak wireless network need about one.
  double arrival = 5;
  double ArrivalLimit() const { return std::min(arrival, patience); }
  bool tls = false;    // https, with a certificate made on the spot
  void Check() const;  // throws Error (usage) naming the field that cannot be
};

// Stops on destruction, within 2 seconds, in which queued messages are sent.
class ViewerServer {
 public:
  virtual ~ViewerServer() = default;
  // URL to open: http://127.0.0.1:8090/, with ?token=… if required.
  virtual const std::string& address() const = 0;
  virtual int port() const = 0;
  virtual int viewers() const = 0;    // number of viewers connected to the live stream
  virtual bool has_page() const = 0;  // false: built without Node.js; a plain page says so
  // SHA-256 of the certificate as browsers display it; empty without TLS.
  virtual const std::string& fingerprint() const = 0;
};

// What the page needs to know of a map that is shown without its run.
struct StillMap {
  std::string cloud_path;  // semidense.ply; empty: none
  std::string mesh_path;   // mesh.ply; empty: none
  // Of both.
  std::array<double, 7> T_world_cloud{0, 0, 0, 1, 0, 0, 0};  // quaternion x y z w, position
};

// Serves the live stream of `hub`, which must outlive the server; without a hub the recorded stream
// in the file `replay_path`. `still`: the stream is a map without its run; null: it is a run.
// Throws Error when the module is missing, the port is in use, or the file cannot be read. Returns
// once the server accepts connections.
std::unique_ptr<ViewerServer> StartViewer(const ServeSettings& settings, StreamHub* hub,
                                          const std::string& replay_path, const std::string& title,
                                          const StillMap* still = nullptr);

// Serves the phone page. `core_folder`: folder of the WebAssembly core (scripts/wasm/build:
// build-wasm); empty: none. `frames`: processes images that pages send, must outlive the server;
// null: not supported.
std::unique_ptr<ViewerServer> StartPhonePage(const ServeSettings& settings,
                                             const std::string& core_folder, FrameHost* frames);

// Serves a page that sends pictures by POST, and answers them. `info`: JSON returned for /map.json.
// `posts` must outlive the server.
std::unique_ptr<ViewerServer> StartPostPage(const ServeSettings& settings, const std::string& info,
                                            PostHost* posts);

// true when `core_folder` contains the variant ("single" or "threads") of the core.
bool HasCore(const std::string& core_folder, const std::string& variant);

}  // namespace alidade
