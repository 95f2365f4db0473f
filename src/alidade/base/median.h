// Median of a range.
#pragma once

#include <algorithm>
#include <cstddef>

namespace alidade {

// Upper median: for an even number of values, the larger of the two middle ones. `values` is a
// vector or span with at least one element and is reordered.
template <typename Values>
auto UpperMedian(Values&& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace alidade
