// TLS before the plain server: connections are taken at the public address, what they say is handed
// on to the server on a loopback port of its own, and back. HTTP and WebSockets know nothing of it.
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
  // `acceptor` listens already. At most `max_connections` at a time; a handshake takes `patience`
  // seconds at most, for the rest the plain server sees to it that nobody stays silent.
  TlsDoor(boost::asio::io_context& io, boost::asio::ip::tcp::acceptor acceptor, int inner_port,
          const TlsCertificate& certificate, int max_connections, double patience);
  void Close();

 private:
  void Accept();

  boost::asio::io_context& io_;
  boost::asio::ip::tcp::acceptor acceptor_;
  boost::asio::ssl::context context_;
  boost::asio::steady_timer rest_;  // after connections could not be taken
  std::vector<std::weak_ptr<TlsRelay>> relays_;
  const int inner_port_, max_connections_;
  const double patience_;
};

}  // namespace alidade
