// Texts as arguments of commands that a user copies to a shell.
#pragma once

#include <algorithm>
#include <string>

namespace alidade {

// In single quotes, as all shells read them.
inline std::string ShellQuoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

// As typed in a shell: in quotes only if needed; control characters as $'\n', so that the line
// stays one and changes nothing on a terminal.
inline std::string ShellWord(const std::string& path) {
  if (!path.empty() && path.front() == '-') return ShellWord("./" + path);  // no option
  constexpr char kPlain[] =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./+=:,@%";
  if (!path.empty() && path.find_first_not_of(kPlain) == std::string::npos) return path;
  const auto is_control = [](char c) { return (c >= 0 && c < ' ') || c == '\x7f'; };
  if (std::none_of(path.begin(), path.end(), is_control)) return ShellQuoted(path);
  std::string quoted = "$'";
  for (const char c : path) {
    if (is_control(c)) {
      constexpr char kDigits[] = "01234567";
      quoted += {'\\', kDigits[c >> 6], kDigits[(c >> 3) & 7], kDigits[c & 7]};
    } else {
      if (c == '\'' || c == '\\') quoted += '\\';
      quoted += c;
    }
  }
  return quoted + "'";
}

}  // namespace alidade
