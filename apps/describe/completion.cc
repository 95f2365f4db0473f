#include "describe/completion.h"

namespace alidade {

std::string ShortHelp(const std::string& help) {
  const size_t end = help.find_first_of(";\n");
  return help.substr(0, end);
}

}  // namespace alidade
