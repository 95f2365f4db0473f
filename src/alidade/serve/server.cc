#include "alidade/serve/server.h"

#include <pthread.h>

#include <algorithm>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/post.hpp>
#include <chrono>
#include <csignal>
#include <stdexcept>
#include <utility>

#include "alidade/serve/frame_client.h"
#include "alidade/serve/http_session.h"
#include "alidade/serve/response.h"
#include "alidade/serve/stream_client.h"

namespace alidade {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

constexpr int kPortsTried = 100;
// Bytes the kernel buffers for a viewer that stopped reading; the default would be up to 4 MB of
// outdated images.
constexpr int kSendBuffer = 64 << 10;
// Until file descriptors may be available again.
constexpr auto kRest = std::chrono::milliseconds(100);
constexpr auto kGoodbye = std::chrono::seconds(2);  // at the end, to send queued messages

asio::ip::address AddressOf(const std::string& host, asio::io_context& io) {
  error_code error;
  asio::ip::address address = asio::ip::make_address(host, error);
  if (!error) return address;
  tcp::resolver resolver(io);
  const auto found = resolver.resolve(host, "", error);
  if (error || found.empty()) throw std::runtime_error("unknown address '" + host + "'");
  return found.begin()->endpoint().address();
}

// Address by which other machines reach this one. Sends nothing; 192.0.2.1 is reserved for
// documentation (RFC 5737).
asio::ip::address OutwardAddress(asio::io_context& io) {
  error_code error;
  asio::ip::udp::socket socket(io);
  socket.open(asio::ip::udp::v4(), error);
  if (!error) socket.connect({asio::ip::make_address_v4("192.0.2.1"), 9}, error);
  const auto local = error ? asio::ip::udp::endpoint() : socket.local_endpoint(error);
  return error ? asio::ip::make_address("127.0.0.1") : local.address();
}

template <class T>
void ForgetEnded(std::vector<std::weak_ptr<T>>& all) {
  all.erase(std::remove_if(all.begin(), all.end(), [](const auto& one) { return one.expired(); }),
            all.end());
}

}  // namespace

std::string UrlAddress(const asio::ip::address& address) {
  if (address.is_v4()) return address.to_string();
  if (address.to_v6().is_v4_mapped())
    return asio::ip::make_address_v4(asio::ip::v4_mapped, address.to_v6()).to_string();
  return "[" + address.to_string() + "]";
}

bool ServerCore::MayJoin() {
  ForgetEnded(clients);
  ForgetEnded(pages);
  return static_cast<int>(clients.size() + pages.size()) < task.settings.max_clients;
}

bool ServerCore::MayConnect() {
  ForgetEnded(clients);
  ForgetEnded(pages);
  ForgetEnded(sessions);
  if (static_cast<int>(clients.size() + pages.size() + sessions.size()) <
      task.settings.max_connections)
    return true;
  std::shared_ptr<HttpSession> oldest;
  for (const auto& one : sessions) {
    const auto session = one.lock();
    if (!session) continue;
    if (!oldest || std::pair(session->admitted(), session->active()) <
                       std::pair(oldest->admitted(), oldest->active()))
      oldest = session;
  }
  if (!oldest) return false;
  oldest->Close();
  return true;
}

Server::Server(const ServeTask& task) : core_(task) {
  const std::string& host = task.settings.host;
  const asio::ip::address address = AddressOf(host, core_.io);
  error_code no_address;
  asio::ip::make_address(host, no_address);
  const std::string token = address.is_loopback() ? "" : RandomToken();
  const std::string name = no_address                 ? host
                           : address.is_unspecified() ? UrlAddress(OutwardAddress(core_.io))
                                                      : UrlAddress(address);
  const bool tls = task.settings.tls;
  if (tls)
    OpenTls(address, name);
  else
    port_ = Listen(address, acceptor_);
  core_.gate.emplace(port_, no_address || tls ? name : "", token, tls);
  const int usual = tls ? 443 : 80;
  address_ = std::string(tls ? "https://" : "http://") + name +
             (port_ == usual ? "" : ":" + std::to_string(port_)) + "/";
  if (!token.empty()) address_ += "?token=" + token;

  core_.box->io = &core_.io;
  Accept();
  // Block all signals in the new thread, so that the program's threads handle them.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  thread_ = std::thread([this] { Run(); });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

Server::~Server() {
  asio::post(core_.io, [this] { Finish(); });
  if (ended_.get_future().wait_for(kGoodbye) == std::future_status::timeout) core_.io.stop();
  thread_.join();
  const std::lock_guard lock(core_.box->mutex);
  core_.box->io = nullptr;
}

bool Server::has_page() const {
  const auto& files = core_.task.phone   ? PhoneFiles()
                      : core_.task.posts ? PostFiles()
                                         : PageFiles();
  return std::any_of(files.begin(), files.end(),
                     [](const PageFile& file) { return file.name == "index.html"; });
}

// The plain server listens on a separate port of the loopback interface.
void Server::OpenTls(const asio::ip::address& host, const std::string& name) {
#ifdef ALIDADE_TLS
  tcp::acceptor outer(core_.io);
  port_ = Listen(host, outer);
  acceptor_.open(tcp::v4());
  acceptor_.bind({asio::ip::address_v4::loopback(), 0});
  acceptor_.listen();
  std::vector<std::string> names = {"localhost", "127.0.0.1"};
  const bool brackets = name.size() > 1 && name.front() == '[';
  const std::string bare = brackets ? name.substr(1, name.size() - 2) : name;
  if (bare != names[0] && bare != names[1]) names.push_back(bare);
  const TlsCertificate certificate = MakeCertificate(names);
  fingerprint_ = certificate.fingerprint;
  const ServeSettings& settings = core_.task.settings;
  door_ = std::make_unique<TlsDoor>(core_.io, std::move(outer), acceptor_.local_endpoint().port(),
                                    certificate, settings.max_connections, settings.ArrivalLimit());
#else
  static_cast<void>(host);
  static_cast<void>(name);
  throw std::runtime_error(
      "this program was built without TLS (install Debian's libssl-dev and build again)");
#endif
}

int Server::Listen(const asio::ip::address& host, tcp::acceptor& acceptor) {
  const ServeSettings& settings = core_.task.settings;
  const int tries = settings.port_given || settings.port == 0 ? 1 : kPortsTried;
  error_code error;
  for (int port = settings.port; port < settings.port + tries && port <= 65535; ++port) {
    const tcp::endpoint endpoint(host, static_cast<unsigned short>(port));
    acceptor = tcp::acceptor(core_.io);
    acceptor.open(endpoint.protocol(), error);
    if (error) break;
    acceptor.set_option(asio::socket_base::reuse_address(true), error);
    acceptor.set_option(asio::socket_base::send_buffer_size(kSendBuffer), error);
    if (host.is_v6()) acceptor.set_option(asio::ip::v6_only(false), error);
    acceptor.bind(endpoint, error);
    if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
    if (!error) {
      return acceptor.local_endpoint().port();
    }
    if (error != asio::error::address_in_use) break;
  }
  const std::string what = settings.host + ":" + std::to_string(settings.port);
  if (error == asio::error::address_in_use) {
    throw std::runtime_error(tries == 1
                                 ? "port " + what + " is in use; choose another port, or none"
                                 : "port " + what + " and the next ones are in use");
  }
  throw std::runtime_error(what + ": " + error.message());
}

void Server::Accept() {
  acceptor_.async_accept([this](error_code error, tcp::socket socket) {
    if (error == asio::error::operation_aborted || !acceptor_.is_open()) return;
    if (error) {  // no descriptors or memory: an immediate retry would fail again
      rest_.expires_after(kRest);
      rest_.async_wait([this](error_code stopped) {
        if (!stopped) Accept();
      });
      return;
    }
    try {
      if (core_.MayConnect()) {
        error_code ignored;
        socket.set_option(tcp::no_delay(true), ignored);
        const auto session = std::make_shared<HttpSession>(std::move(socket), core_);
        core_.sessions.push_back(session);
        session->Start();
      }
    } catch (...) {  // out of memory: drops this connection only
    }
    Accept();
  });
}

void Server::Run() {
  pthread_setname_np(pthread_self(), "viewer");
  for (bool done = false; !done;) {
    try {
      core_.io.run();
      done = true;
    } catch (...) {  // a handler failed (out of memory); only its connection is lost
    }
  }
  ended_.set_value();
}

// Without connections run() has no work left and returns.
void Server::Finish() {
  error_code ignored;
  acceptor_.close(ignored);
  rest_.cancel();
#ifdef ALIDADE_TLS
  if (door_) door_->Close();
#endif
  for (const auto& one : core_.sessions) {
    if (const auto session = one.lock()) session->Close();
  }
  core_.waiting.clear();
  for (const auto& one : core_.clients) {
    if (const auto client = one.lock()) client->Finish();
  }
  for (const auto& one : core_.pages) {
    if (const auto page = one.lock()) page->Finish();
  }
}

}  // namespace alidade
