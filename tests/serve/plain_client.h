// A client for tests of the server: sends arbitrary bytes and waits for answers, with blocking
// sockets and without a library that would correct the input.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace alidade {

class PlainClient {
 public:
  // `receive_buffer`: size of the kernel's receive buffer in bytes; 0: default.
  explicit PlainClient(int port, int receive_buffer = 0) : port_(port) {
    fd_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (fd_ < 0) throw std::runtime_error("no socket");
    if (receive_buffer > 0)
      setsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
    timeval patience{60, 0};
    setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    setsockopt(fd_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
      close(fd_);
      throw std::runtime_error("cannot connect");
    }
  }
  ~PlainClient() {
    if (fd_ >= 0) close(fd_);
  }
  PlainClient(PlainClient&& other) noexcept
      : fd_(std::exchange(other.fd_, -1)), port_(other.port_), in_(std::move(other.in_)) {}
  PlainClient& operator=(PlainClient&&) = delete;

  bool Send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t sent = send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return false;
      bytes.remove_prefix(static_cast<size_t>(sent));
    }
    return true;
  }
  void EndOfSending() { shutdown(fd_, SHUT_WR); }

  // Reads more bytes; false when the server has closed the connection.
  bool Receive() {
    char part[65536];
    const ssize_t got = recv(fd_, part, sizeof part, 0);
    if (got <= 0) return false;
    in_.append(part, static_cast<size_t>(got));
    return true;
  }
  std::string ReceiveAll() {
    while (Receive()) {
    }
    return std::exchange(in_, {});
  }
  bool ReceiveBytes(size_t count) {
    while (in_.size() < count) {
      if (!Receive()) return false;
    }
    return true;
  }

  std::string Host() const { return "127.0.0.1:" + std::to_string(port_); }
  // Sends a request and returns the whole answer. `lines`: headers, each ended by \r\n; Host is
  // added if missing.
  std::string Ask(const std::string& first_line, const std::string& lines = "") {
    Send(first_line + " HTTP/1.1\r\nConnection: close\r\n" +
         (lines.find("Host:") == std::string::npos ? "Host: " + Host() + "\r\n" : "") + lines +
         "\r\n");
    return ReceiveAll();
  }

  // Returns the status; 101 means that the connection is now a WebSocket.
  int Upgrade(const std::string& target = "/stream", const std::string& lines = "") {
    Send("GET " + target + " HTTP/1.1\r\n" +
         (lines.find("Host:") == std::string::npos ? "Host: " + Host() + "\r\n" : "") +
         "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
         "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
         lines + "\r\n");
    size_t end;
    while ((end = in_.find("\r\n\r\n")) == std::string::npos) {
      if (!Receive()) break;
    }
    const int status = in_.size() > 12 ? std::atoi(in_.c_str() + 9) : 0;
    if (end != std::string::npos) in_.erase(0, end + 4);
    return status;
  }

  // A final client frame, masked with zeros. `opcode`: 1 text, 2 binary, 8 close.
  static std::string Frame(int opcode, std::string_view payload) {
    std::string frame(1, static_cast<char>(0x80 | opcode));
    const size_t size = payload.size();
    if (size < 126) {
      frame += static_cast<char>(0x80 | size);
    } else if (size < 65536) {
      frame += static_cast<char>(0x80 | 126);
      for (int shift = 8; shift >= 0; shift -= 8) frame += static_cast<char>(size >> shift);
    } else {
      frame += static_cast<char>(0x80 | 127);
      for (int shift = 56; shift >= 0; shift -= 8) frame += static_cast<char>(size >> shift);
    }
    return frame.append(4, '\0').append(payload);
  }
  bool Say(std::string_view text) { return Send(Frame(1, text)); }

  // The next binary message, assembled from its frames; answers pings. nullopt when closed; see
  // close_code().
  std::optional<std::string> Message() {
    std::string message;
    while (true) {
      if (!ReceiveBytes(2)) return std::nullopt;
      const auto byte = [&](size_t i) { return static_cast<uint8_t>(in_[i]); };
      uint64_t size = byte(1) & 127;
      const size_t extra = size == 126 ? 2 : size == 127 ? 8 : 0;
      if (!ReceiveBytes(2 + extra)) return std::nullopt;
      if (extra > 0) size = 0;
      for (size_t i = 0; i < extra; ++i) size = size << 8 | byte(2 + i);
      if (!ReceiveBytes(2 + extra + size)) return std::nullopt;
      const int opcode = byte(0) & 15;
      const bool last = (byte(0) & 128) != 0;
      const std::string payload = in_.substr(2 + extra, size);
      in_.erase(0, 2 + extra + size);
      if (opcode == 8) {
        if (payload.size() >= 2) {
          close_code_ = static_cast<uint8_t>(payload[0]) << 8 | static_cast<uint8_t>(payload[1]);
        }
        Send(Frame(8, payload));
        EndOfSending();
        return std::nullopt;
      }
      if (opcode == 9) Send(Frame(10, payload));
      if (opcode > 2) continue;
      message += payload;
      if (last) return message;
    }
  }
  int close_code() const { return close_code_; }

 private:
  int fd_ = -1;
  int port_ = 0;
  std::string in_;
  int close_code_ = 0;
};

}  // namespace alidade
