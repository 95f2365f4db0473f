// Access control of the server, based on a request's headers.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace alidade {

struct Caller {
  std::optional<std::string_view> host;    // Host header; nullopt when absent or repeated
  std::optional<std::string_view> origin;  // Origin header
  std::string_view target;                 // from the request line: /path?query
  std::string local;  // the server's address the request arrived at, as in a URL: [::1] in brackets
  bool loopback = false;  // `local` is a loopback address
};

class Gate {
 public:
  // `name`: host name set by the user; empty: none. `token`: empty when none is required. `tls`:
  // pages are served by https and connections come from the TLS proxy; every client may then use
  // the name, localhost or 127.0.0.1.
  Gate(int port, std::string name, std::string token, bool tls = false);
  // Returns why the caller is refused, one line; empty if it is admitted.
  // Host must be the server's address or its name: this prevents DNS rebinding by pages of other
  // hosts. Origin, which browsers send with WebSockets and cross-origin requests, must be the
  // page's own.
  std::string Refusal(const Caller& caller) const;
  // true when the target's query contains the token. The comparison takes constant time.
  bool HasToken(std::string_view target) const;

 private:
  bool IsOurs(std::string_view host, const Caller& caller) const;

  std::string port_;  // ":8090"
  std::string name_;
  std::string token_;
  bool tls_ = false;
};

// 128 random bits of the operating system as 32 hexadecimal digits.
std::string RandomToken();

// Removes the query from "/path?query".
std::string_view PathOf(std::string_view target);

}  // namespace alidade
