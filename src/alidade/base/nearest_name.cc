#include "alidade/base/nearest_name.h"

#include <algorithm>
#include <cctype>
#include <vector>

namespace alidade {
namespace {

char Lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

}  // namespace

int EditDistance(std::string_view a, std::string_view b) {
  const size_t rows = a.size() + 1, columns = b.size() + 1;
  std::vector<std::vector<int>> d(rows, std::vector<int>(columns));
  for (size_t i = 0; i < rows; ++i) d[i][0] = static_cast<int>(i);
  for (size_t j = 0; j < columns; ++j) d[0][j] = static_cast<int>(j);
  for (size_t i = 1; i < rows; ++i) {
    for (size_t j = 1; j < columns; ++j) {
      const bool same = Lower(a[i - 1]) == Lower(b[j - 1]);
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + !same});
      const bool swapped = i > 1 && j > 1 && Lower(a[i - 1]) == Lower(b[j - 2]) &&
                           Lower(a[i - 2]) == Lower(b[j - 1]);
      if (swapped) d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[rows - 1][columns - 1];
}

std::string NearestName(std::string_view written, std::span<const std::string> known) {
  std::string nearest;
  int smallest = 0;
  for (const std::string& name : known) {
    const int distance = EditDistance(written, name);
    // Half the letters wrong is another word, not a slip.
    const int limit =
        static_cast<int>(std::max<size_t>(1, std::max(written.size(), name.size()) / 2));
    if (distance > limit) continue;
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
