#include "alidade/io/text.h"

#include <locale.h>
#include <stdlib.h>

#include <algorithm>
#include <string>

#include "alidade/base/error.h"

namespace alidade {
namespace {

constexpr std::string_view kBlanks = " \t\r\v\f";

std::string_view Trimmed(std::string_view text) {
  const size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

}  // namespace

void CheckIsText(std::string_view bytes, const std::string& name) {
  const std::string_view mark = bytes.substr(0, 2);
  if (mark == "\xff\xfe" || mark == "\xfe\xff")
    ThrowInput(name + " is written in UTF-16: save it as UTF-8 or plain ASCII");
  if (bytes.find('\0') != std::string_view::npos)
    ThrowInput(name + " is not a text file: it contains bytes of 0");
  size_t lines = 0;
  for (size_t begin = 0; begin < bytes.size(); ++lines) {
    if (lines == kMostLines)
      ThrowInput(name + " has more than " + std::to_string(kMostLines) + " lines");
    const size_t end = std::min(bytes.find('\n', begin), bytes.size());
    if (end - begin > kMostLineBytes)
      ThrowInput(name + ":" + std::to_string(lines + 1) + ": the line is longer than " +
                 std::to_string(kMostLineBytes) + " bytes");
    begin = end + 1;
  }
}

std::vector<TextLine> ContentLines(std::string_view text) {
  if (text.substr(0, 3) == "\xef\xbb\xbf")
    text.remove_prefix(3);  // byte order mark, written by Windows editors
  std::vector<TextLine> lines;
  for (int number = 1; !text.empty(); ++number) {
    const size_t end = text.find('\n');
    const std::string_view line = Trimmed(text.substr(0, end));
    if (!line.empty() && line.front() != '#') lines.push_back({number, line});
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  return lines;
}

std::vector<std::string_view> Fields(std::string_view line) {
  constexpr std::string_view kSeparators = " \t\r\v\f,";
  std::vector<std::string_view> fields;
  for (size_t begin = line.find_first_not_of(kSeparators); begin != std::string_view::npos;) {
    const size_t end = line.find_first_of(kSeparators, begin);
    fields.push_back(line.substr(begin, end - begin));
    begin = end == std::string_view::npos ? end : line.find_first_not_of(kSeparators, end);
  }
  return fields;
}

std::optional<double> ParseNumber(std::string_view text) {
  // Older libc++ lacks from_chars(double), and strtod depends on the locale's decimal separator.
  static const locale_t kClassic = newlocale(LC_ALL_MASK, "C", static_cast<locale_t>(nullptr));
  const std::string copy(text);
  char* end = nullptr;
  const double value = strtod_l(copy.c_str(), &end, kClassic);
  if (copy.empty() || end != copy.c_str() + copy.size()) return std::nullopt;
  return value;
}

}  // namespace alidade
