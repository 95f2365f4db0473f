// Texts as arguments of commands that a user copies to a shell.
#pragma once

#include <string>

namespace alidade {

// In single quotes, as bash and zsh read them.
inline std::string ShellQuoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

// As a user would type it: in quotes only if needed.
inline std::string ShellWord(const std::string& text) {
  constexpr char kPlain[] =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./+=:,@%";
  const bool plain = !text.empty() && text.find_first_not_of(kPlain) == std::string::npos;
  return plain ? text : ShellQuoted(text);
}

}  // namespace alidade
