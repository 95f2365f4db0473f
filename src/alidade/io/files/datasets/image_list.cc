#include "alidade/io/files/datasets/image_list.h"

#include <algorithm>

#include "alidade/io/files/file.h"
#include "alidade/io/files/image_file.h"

namespace alidade {
namespace {

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

// Returns the digits at position `at` without leading zeros, and moves `at` past them.
std::string_view TakeNumber(std::string_view text, size_t& at) {
  while (at + 1 < text.size() && text[at] == '0' && IsDigit(text[at + 1])) ++at;
  const size_t begin = at;
  while (at < text.size() && IsDigit(text[at])) ++at;
  return text.substr(begin, at - begin);
}

}  // namespace

bool NaturallyBefore(const std::string& a, const std::string& b) {
  size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (IsDigit(a[i]) && IsDigit(b[j])) {
      const std::string_view x = TakeNumber(a, i), y = TakeNumber(b, j);
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
    } else {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
    }
  }
  if (a.size() - i != b.size() - j) return a.size() - i < b.size() - j;
  return a < b;  // equal except for leading zeros
}

std::vector<std::string> ImagesIn(const std::string& folder) {
  std::vector<std::string> names;
  // Entries that are neither files nor folders stay in the list; reading them reports the error.
  for (const std::string& name : NamesIn(folder)) {
    if (name.front() != '.' && HasImageEnding(name) && !IsFolder(folder + "/" + name))
      names.push_back(name);
  }
  std::sort(names.begin(), names.end(), NaturallyBefore);
  return names;
}

}  // namespace alidade
