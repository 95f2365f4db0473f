#include "describe/completion.h"

namespace alidade {

std::string ShortHelp(const std::string& help) {
  const size_t end = help.find_first_of(";\n");
  return help.substr(0, end);
}

std::string ShellQuoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace alidade
