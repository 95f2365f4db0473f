// The middle one of many values.
#pragma once

#include <algorithm>
#include <cstddef>

namespace alidade {

// The larger of the middle two when their number is even. `values`: a vector or span with at least
// one; their order changes.
template <typename Values>
auto UpperMedian(Values&& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace alidade
