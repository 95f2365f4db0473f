// Association of two lists of times by nearest time.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

// Returns pairs (index in a, index in b) of the nearest times less than `max_dt` seconds apart.
// Each item is used at most once; the closest pairs are taken first, as in TUM's associate.py. The
// result is sorted by the index in a. The lists need not be sorted; a NaN is never paired.
std::vector<std::pair<int, int>> AssociateByTime(std::span<const double> a,
                                                 std::span<const double> b, double max_dt);

}  // namespace alidade
