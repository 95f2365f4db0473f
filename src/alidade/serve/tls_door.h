// TLS proxy in front of the plain server: accepts connections at the public address and forwards
// the decrypted data to the server on a loopback port. The HTTP and WebSocket code is independent
// of TLS.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <memory>
#include <vector>

#include "alidade/serve/tls_certificate.h"

namespace alidade {

class TlsRelay;

class TlsDoor {
 public:
  // `acceptor` is already listening. The plain server has at most `max_connections` connections and
  // enforces its own timeouts. Besides these there are at most a quarter as many without a complete
  // handshake, which may take `handshake` seconds; a new connection closes the oldest of them.
  TlsDoor(boost::asio::io_context& io, boost::asio::ip::tcp::acceptor acceptor, int inner_port,
          const TlsCertificate& certificate, int max_connections, double handshake);
  void Close();

 private:
  void Accept();
  void MakeRoom();

  boost::asio::io_context& io_;
  boost::asio::ip::tcp::acceptor acceptor_;
  boost::asio::ssl::context context_;
  boost::asio::steady_timer rest_;  // delays accepting after a failure
  std::vector<std::weak_ptr<TlsRelay>> relays_;
  const int inner_port_, max_waiting_;
  const double handshake_;  // seconds
};

}  // namespace alidade
