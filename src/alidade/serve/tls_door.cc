#include "alidade/serve/tls_door.h"

#include <openssl/ssl.h>

#include <algorithm>
#include <array>
#include <boost/asio/ssl/stream.hpp>
#include <boost/asio/write.hpp>
#include <chrono>
#include <utility>

namespace alidade {

namespace tls_asio = boost::asio;

// One proxied connection: two loops, each reading from one side and writing to the other.
class TlsRelay : public std::enable_shared_from_this<TlsRelay> {
 public:
  using Tcp = tls_asio::ip::tcp;
  using Error = boost::system::error_code;

  TlsRelay(Tcp::socket socket, tls_asio::io_context& io, tls_asio::ssl::context& context)
      : outer_(std::move(socket), context), inner_(io), timer_(io) {}

  void Start(int inner_port, double handshake) {
    timer_.expires_after(std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(handshake)));
    timer_.async_wait([self = weak_from_this()](Error stopped) {
      const auto relay = self.lock();
      if (relay && !stopped) relay->Close();
    });
    outer_.async_handshake(tls_asio::ssl::stream_base::server,
                           [self = shared_from_this(), inner_port](Error error) {
                             if (error) return self->Close();
                             const Tcp::endpoint inner(tls_asio::ip::address_v4::loopback(),
                                                       static_cast<unsigned short>(inner_port));
                             self->inner_.async_connect(inner, [self](Error failed) {
                               self->timer_.cancel();
                               if (failed) return self->Close();
                               self->passing_ = true;
                               Error ignored;
                               self->inner_.set_option(Tcp::no_delay(true), ignored);
                               self->Pass(self->outer_, self->inner_, self->in_);
                               self->Pass(self->inner_, self->outer_, self->out_);
                             });
                           });
  }

  // The handshake is complete and the server has not closed the connection.
  bool passing() const { return passing_; }

  void Close() {
    Error ignored;
    passing_ = false;
    timer_.cancel();
    inner_.close(ignored);
    outer_.lowest_layer().close(ignored);
  }

 private:
  using Buffer = std::array<char, 16384>;  // bytes, the maximum size of a TLS record

  template <class From, class To>
  void Pass(From& from, To& to, Buffer& buffer) {
    from.async_read_some(tls_asio::buffer(buffer), [self = shared_from_this(), &from, &to, &buffer](
                                                       Error error, size_t count) {
      if (error) return self->End(&from == static_cast<void*>(&self->inner_));
      tls_asio::async_write(to, tls_asio::buffer(buffer.data(), count),
                            [self, &from, &to, &buffer](Error failed, size_t) {
                              if (failed) return self->Close();
                              self->Pass(from, to, buffer);
                            });
    });
  }

  // The server closed the connection: shut down the TLS session as the protocol requires.
  void End(bool by_server) {
    if (!by_server) return Close();
    passing_ = false;
    outer_.async_shutdown([self = shared_from_this()](Error) { self->Close(); });
    timer_.expires_after(std::chrono::seconds(1));
    timer_.async_wait([self = shared_from_this()](Error stopped) {
      if (!stopped) self->Close();
    });
  }

  tls_asio::ssl::stream<Tcp::socket> outer_;
  Tcp::socket inner_;
  tls_asio::steady_timer timer_;
  bool passing_ = false;
  Buffer in_, out_;
};

TlsDoor::TlsDoor(tls_asio::io_context& io, tls_asio::ip::tcp::acceptor acceptor, int inner_port,
                 const TlsCertificate& certificate, int max_connections, double handshake)
    : io_(io),
      acceptor_(std::move(acceptor)),
      context_(tls_asio::ssl::context::tls_server),
      rest_(io),
      inner_port_(inner_port),
      max_waiting_(std::max(1, max_connections / 4)),
      handshake_(handshake) {
  SSL_CTX_set_min_proto_version(context_.native_handle(), TLS1_2_VERSION);
  context_.use_certificate(tls_asio::buffer(certificate.certificate), tls_asio::ssl::context::pem);
  context_.use_private_key(tls_asio::buffer(certificate.key), tls_asio::ssl::context::pem);
  Accept();
}

void TlsDoor::Accept() {
  acceptor_.async_accept([this](boost::system::error_code error, TlsRelay::Tcp::socket socket) {
    if (error == tls_asio::error::operation_aborted || !acceptor_.is_open()) return;
    if (error) {  // no descriptors or memory: an immediate retry would fail again
      rest_.expires_after(std::chrono::milliseconds(100));
      rest_.async_wait([this](boost::system::error_code stopped) {
        if (!stopped) Accept();
      });
      return;
    }
    MakeRoom();
    boost::system::error_code ignored;
    socket.set_option(TlsRelay::Tcp::no_delay(true), ignored);
    const auto relay = std::make_shared<TlsRelay>(std::move(socket), io_, context_);
    relays_.push_back(relay);
    relay->Start(inner_port_, handshake_);
    Accept();
  });
}

// The server limits the connections it has; those it does not have are limited here.
void TlsDoor::MakeRoom() {
  relays_.erase(
      std::remove_if(relays_.begin(), relays_.end(), [](const auto& one) { return one.expired(); }),
      relays_.end());
  int waiting = 0;
  std::shared_ptr<TlsRelay> oldest;
  for (const auto& one : relays_) {  // in order of arrival
    auto relay = one.lock();
    if (!relay || relay->passing()) continue;
    ++waiting;
    if (!oldest) oldest = std::move(relay);
  }
  if (waiting >= max_waiting_) oldest->Close();
}

void TlsDoor::Close() {
  boost::system::error_code ignored;
  acceptor_.close(ignored);
  rest_.cancel();
  for (const auto& one : relays_) {
    if (const auto relay = one.lock()) relay->Close();
  }
}

}  // namespace alidade
