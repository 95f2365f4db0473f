// Long paths at decreasing resolution.
#pragma once

#include <cstddef>
#include <vector>

namespace alidade {

// Removes every second entry of the older half, which comes first.
template <typename T>
void ThinOlderHalf(std::vector<T>& entries) {
  size_t kept = 0;
  for (size_t i = 0; i < entries.size(); ++i) {
    if (i < entries.size() / 2 && i % 2 == 1) continue;
    entries[kept++] = entries[i];
  }
  entries.resize(kept);
}

}  // namespace alidade
