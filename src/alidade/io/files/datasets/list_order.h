// The order of time of a list of stamped files.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "alidade/io/files/datasets/stamped_list.h"

namespace alidade {

struct ListOrder {
  std::vector<double> times;  // of each item; one with a problem has the time of the item before
  std::vector<int> part;      // of each item: which of the joined recordings it belongs to, from 0
  std::vector<size_t> order;  // indices of the items by part, then by time
  bool sorted = false;        // `order` is not that of the list
  int parts() const { return part.empty() ? 0 : *std::max_element(part.begin(), part.end()) + 1; }
};

// Writers that run side by side put stamps down up to a second out of order. A larger step back is
// the begin of another recording, unless only the item itself or the one before it is out of line
// (a damaged stamp): an item that is out of line belongs where its time says.
ListOrder OrderOf(const std::vector<StampedName>& list);

}  // namespace alidade
