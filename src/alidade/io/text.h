// Lines, fields and numbers of text files, independent of the locale.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace alidade {

// Limit of lines in a file: short lines take about a hundred times their size in memory once
// parsed. Ten million lines are four days at 30 frames per second.
inline constexpr size_t kMostLines = 10'000'000;
inline constexpr size_t kMostLineBytes = size_t{1} << 16;  // a path has at most 4096

// Throws Error (input) naming the file when `bytes` is UTF-16, contains zero bytes, or exceeds the
// limits above.
void CheckIsText(std::string_view bytes, const std::string& name);

struct TextLine {
  int number;             // from 1, for errors of the form file:line
  std::string_view text;  // without line end and surrounding whitespace; never empty or a # comment
};

// Returns all lines except empty ones and comments. `text` must outlive the result.
std::vector<TextLine> ContentLines(std::string_view text);

// Splits at whitespace and commas.
std::vector<std::string_view> Fields(std::string_view line);

// Parses all of `text` as a number; nullopt when it is not one. NaN and infinities are numbers.
std::optional<double> ParseNumber(std::string_view text);

}  // namespace alidade
