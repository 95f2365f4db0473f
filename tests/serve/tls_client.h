// A TLS client for tests of the server, which accepts any certificate.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <openssl/ssl.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

namespace alidade {

class TlsClient {
 public:
  explicit TlsClient(int port, bool handshake = true) : port_(port) {
    fd_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const timeval patience{60, 0};
    setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    setsockopt(fd_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (fd_ < 0 || connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0)
      throw std::runtime_error("cannot connect");
    if (!handshake) return;
    static SSL_CTX* context = SSL_CTX_new(TLS_client_method());
    tls_.reset(SSL_new(context));
    SSL_set_fd(tls_.get(), fd_);
    if (SSL_connect(tls_.get()) != 1) tls_.reset();
  }
  ~TlsClient() {
    tls_.reset();
    if (fd_ >= 0) close(fd_);
  }
  TlsClient(TlsClient&& other) noexcept
      : fd_(std::exchange(other.fd_, -1)), port_(other.port_), tls_(std::move(other.tls_)) {}
  TlsClient& operator=(TlsClient&&) = delete;

  bool Secure() const { return tls_ != nullptr; }
  // Sends a request on a connection that stays open, and returns the status; 0: no answer.
  int Ask(const std::string& target) {
    if (!tls_) return 0;
    const std::string request =
        "GET " + target + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port_) + "\r\n\r\n";
    if (SSL_write(tls_.get(), request.data(), static_cast<int>(request.size())) <= 0) return 0;
    char answer[16384];
    const int got = SSL_read(tls_.get(), answer, sizeof answer);
    return got > 12 ? std::stoi(std::string(answer + 9, 3)) : 0;
  }
  // Waits until the server closes the connection; false after a minute.
  bool IsClosed() {
    char bytes[4096];
    ssize_t got = 0;
    while ((got = recv(fd_, bytes, sizeof bytes, 0)) > 0) {
    }
    return got == 0 || errno == ECONNRESET;
  }

 private:
  struct Free {
    void operator()(SSL* tls) const { SSL_free(tls); }
  };
  int fd_ = -1;
  int port_ = 0;
  std::unique_ptr<SSL, Free> tls_;
};

}  // namespace alidade
