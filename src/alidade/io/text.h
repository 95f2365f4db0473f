// Lines, fields and numbers of text files, the same in every locale.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace alidade {

// Of two bytes each, lines take a hundred times as much memory once they are read. Ten million are
// four days at 30 frames a second.
inline constexpr size_t kMostLines = 10'000'000;
inline constexpr size_t kMostLineBytes = size_t{1} << 16;  // a path has 4096 at most

// Throws Error (input), naming the file, when the bytes are none of a text we can read: UTF-16 as
// some editors write it, no text at all (bytes of 0 in it), or beyond the limits above.
void CheckIsText(std::string_view bytes, const std::string& name);

struct TextLine {
  int number;             // from 1, for errors that say file:line
  std::string_view text;  // without line end and surrounding blanks; never empty, never a # comment
};

// The lines that say something. `text` must outlive the result.
std::vector<TextLine> ContentLines(std::string_view text);

// Fields between blanks, tabs and commas.
std::vector<std::string_view> Fields(std::string_view line);

// The whole of `text` as a number; nullopt when it is something else. NaN and infinities count as
// numbers.
std::optional<double> ParseNumber(std::string_view text);

}  // namespace alidade
