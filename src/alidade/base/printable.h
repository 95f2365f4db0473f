// Makes text read from files safe to print on one line of a terminal.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace alidade {

// Replaces every character that is not printable ASCII by '?'. A damaged file may contain line
// breaks, terminal control sequences, or zero bytes that would truncate an error message.
inline std::string Printable(std::string_view text) {
  std::string shown(text);
  std::replace_if(
      shown.begin(), shown.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return shown;
}

}  // namespace alidade
