#include "alidade/serve/gate.h"

#include <sys/random.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

namespace alidade {
namespace {

char Lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool SameName(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return Lower(x) == Lower(y); });
}

bool SameSecret(std::string_view a, std::string_view b) {
  unsigned difference = a.size() == b.size() ? 0 : 1;
  for (size_t i = 0; i < b.size(); ++i) {
    const char given = i < a.size() ? a[i] : '\0';
    difference |= static_cast<unsigned>(static_cast<unsigned char>(given ^ b[i]));
  }
  return difference == 0;
}

}  // namespace

Gate::Gate(int port, std::string name, std::string token, bool tls)
    : port_(":" + std::to_string(port)),
      name_(std::move(name)),
      token_(std::move(token)),
      tls_(tls) {}

bool Gate::IsOurs(std::string_view host, const Caller& caller) const {
  if (host.size() > port_.size() && host.substr(host.size() - port_.size()) == port_) {
    host.remove_suffix(port_.size());
  } else if (port_ != (tls_ ? ":443" : ":80")) {  // browsers omit the default port
    return false;
  }
  if (SameName(host, caller.local) || (!name_.empty() && SameName(host, name_))) return true;
  if (tls_ && SameName(host, "127.0.0.1")) return true;
  return caller.loopback && SameName(host, "localhost");
}

std::string Gate::Refusal(const Caller& caller) const {
  if (!caller.host || !IsOurs(*caller.host, caller)) return "the request names another host";
  if (caller.origin &&
      !SameName(*caller.origin, (tls_ ? "https://" : "http://") + std::string(*caller.host)))
    return "requests from pages of other hosts are refused";
  return "";
}

bool Gate::HasToken(std::string_view target) const {
  if (token_.empty()) return true;
  const size_t mark = target.find('?');
  std::string_view query = mark == std::string_view::npos ? "" : target.substr(mark + 1);
  while (!query.empty()) {
    const size_t end = std::min(query.find('&'), query.size());
    const std::string_view part = query.substr(0, end);
    if (part.substr(0, 6) == "token=") return SameSecret(part.substr(6), token_);
    query.remove_prefix(std::min(end + 1, query.size()));
  }
  return false;
}

std::string RandomToken() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw std::runtime_error("the system provides no random numbers");
  std::string token;
  for (const unsigned char byte : bytes) {
    token += "0123456789abcdef"[byte >> 4];
    token += "0123456789abcdef"[byte & 15];
  }
  return token;
}

std::string_view PathOf(std::string_view target) { return target.substr(0, target.find('?')); }

}  // namespace alidade
