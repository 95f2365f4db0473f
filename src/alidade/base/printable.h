// Names out of files, as they can be shown in one line of a terminal.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace alidade {

// What is no printable ASCII character is '?': a damaged file may hold line ends, the terminal's
// own commands, and zeros, at which an error would end.
inline std::string Printable(std::string_view text) {
  std::string shown(text);
  std::replace_if(
      shown.begin(), shown.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return shown;
}

}  // namespace alidade
