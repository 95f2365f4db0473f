// Whom the server lets in, by what a request says of where it comes from.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace alidade {

struct Caller {
  std::optional<std::string_view> host;    // header Host; none when it came twice, too
  std::optional<std::string_view> origin;  // header Origin
  std::string_view target;                 // of the request line: /path?query
  std::string local;      // the address of ours that it came to, as in a URL: [::1] in brackets
  bool loopback = false;  // that address is
};

class Gate {
 public:
  // `name`: what else we are called, when the user gave a name; `token`: empty when none is needed.
  // `tls`: pages are https, and connections come from the TLS door: any may use the name, localhost
  // or 127.0.0.1.
  Gate(int port, std::string name, std::string token, bool tls = false);
  // Why the caller is refused, one line; empty when it may come in.
  //   Host must be an address of ours or the name: a page of another host whose name was made to
  // lead here (DNS rebinding) is told by it. Origin, which browsers send with what other pages ask
  // for and with WebSockets, must be the page's own.
  std::string Refusal(const Caller& caller) const;
  // The target's query holds the token. Compared in a time that does not depend on where they
  // differ.
  bool HasToken(std::string_view target) const;

 private:
  bool IsOurs(std::string_view host, const Caller& caller) const;

  std::string port_;  // ":8090"
  std::string name_;
  std::string token_;
  bool tls_ = false;
};

// 128 random bits from the system, as 32 hexadecimal digits.
std::string RandomToken();

// "/path?query" without its query.
std::string_view PathOf(std::string_view target);

}  // namespace alidade
