// The server. All connections are accepted and served in one thread.
#pragma once

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstdint>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "alidade/serve/gate.h"
#include "alidade/serve/serve_module.h"
#ifdef ALIDADE_TLS
#include "alidade/serve/tls_door.h"
#else
namespace alidade {
class TlsDoor {};
}  // namespace alidade
#endif

namespace alidade {

class FrameClient;
class HttpSession;
class StreamClient;

// The address as in a URL: IPv6 in brackets.
std::string UrlAddress(const boost::asio::ip::address& address);

// Brings answers of other threads to the server's thread, while it lives.
struct PostBox {
  std::mutex mutex;
  boost::asio::io_context* io = nullptr;  // guarded by `mutex`; null: the server has ended
};

// State shared by the connections. `io` is the first member and so destroyed last; its pending
// handlers refer to other members only through objects they own.
struct ServerCore {
  explicit ServerCore(const ServeTask& given) : task(given) {}

  boost::asio::io_context io{1};
  const ServeTask task;
  std::optional<Gate> gate;
  std::vector<std::weak_ptr<HttpSession>> sessions;
  std::vector<std::weak_ptr<StreamClient>> clients;
  std::vector<std::weak_ptr<FrameClient>> pages;  // pages that send images
  bool warned_of_page = false;                    // that it does not read
  std::shared_ptr<std::atomic<int>> viewers = std::make_shared<std::atomic<int>>(0);
  // Sessions whose request the host has, by a number of the request.
  std::map<uint64_t, std::shared_ptr<HttpSession>> waiting;
  uint64_t last_request = 0;
  // Of bodies that are being received or with the host.
  std::shared_ptr<size_t> posted_bytes = std::make_shared<size_t>(0);
  std::shared_ptr<PostBox> box = std::make_shared<PostBox>();

  bool MayJoin();  // false when the maximum number of viewers is reached
  // Makes room for a connection by closing the one that was idle longest and is not a viewer, first
  // among those that have not shown the token. Returns false when all are viewers.
  bool MayConnect();
};

class Server : public ViewerServer {
 public:
  explicit Server(const ServeTask& task);  // throws std::exception
  ~Server() override;
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  const std::string& address() const override { return address_; }
  int port() const override { return port_; }
  int viewers() const override { return *core_.viewers; }
  bool has_page() const override;
  const std::string& fingerprint() const override { return fingerprint_; }

 private:
  // Listens at the port of the settings or one of the following ports, and returns its number.
  int Listen(const boost::asio::ip::address& host, boost::asio::ip::tcp::acceptor& acceptor);
  void OpenTls(const boost::asio::ip::address& host, const std::string& name);
  void Accept();
  void Run();
  void Finish();

  ServerCore core_;
  boost::asio::ip::tcp::acceptor acceptor_{core_.io};
  boost::asio::steady_timer rest_{core_.io};  // delays accepting after a failure
  std::unique_ptr<TlsDoor> door_;             // null without TLS
  std::string address_, fingerprint_;
  int port_ = 0;
  std::promise<void> ended_;
  std::thread thread_;
};

}  // namespace alidade
