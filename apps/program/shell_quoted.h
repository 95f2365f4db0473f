#pragma once

#include <string>

namespace alidade {

// In single quotes, as bash and zsh read them.
inline std::string ShellQuoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace alidade
