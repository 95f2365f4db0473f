#include "alidade/base/nearest_name.h"

#include <algorithm>
#include <cctype>
#include <utility>
#include <vector>

namespace alidade {
namespace {

char Lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

}  // namespace

int EditDistance(std::string_view a, std::string_view b) {
  // Rows i - 2, i - 1 and i of the table; entry j is the distance between the first i letters of a
  // and the first j letters of b.
  std::vector<int> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) row[j] = static_cast<int>(j);
  for (size_t i = 1; i <= a.size(); ++i) {
    std::swap(before, last);
    std::swap(last, row);
    row[0] = static_cast<int>(i);
    for (size_t j = 1; j <= b.size(); ++j) {
      const bool same = Lower(a[i - 1]) == Lower(b[j - 1]);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + !same});
      const bool swapped = i > 1 && j > 1 && Lower(a[i - 1]) == Lower(b[j - 2]) &&
                           Lower(a[i - 2]) == Lower(b[j - 1]);
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row[b.size()];
}

std::string NearestName(std::string_view written, std::span<const std::string> known) {
  std::string nearest;
  int smallest = 0;
  for (const std::string& name : known) {
    // If half the letters differ, it is a different word rather than a typing error.
    const size_t longer = std::max(written.size(), name.size());
    const size_t limit = std::max<size_t>(1, longer / 2);
    // The difference in length is a lower bound of the distance; skips the comparison for very long
    // input.
    if (longer - std::min(written.size(), name.size()) > limit) continue;
    const int distance = EditDistance(written, name);
    if (static_cast<size_t>(distance) > limit) continue;
    if (nearest.empty() || distance < smallest) {
      nearest = name;
      smallest = distance;
    }
  }
  return nearest;
}

std::string DidYouMean(std::string_view written, std::span<const std::string> known) {
  const std::string nearest = NearestName(written, known);
  return nearest.empty() ? "" : "; did you mean '" + nearest + "'?";
}

}  // namespace alidade
