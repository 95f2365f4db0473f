// Which items of two stamped lists belong together.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

// Pairs (index in a, index in b) of the nearest times less than `max_dt` seconds apart, one to one,
// best first as in TUM's associate.py; returned in the order of a. The lists may be in any order;
// NaN matches nothing.
std::vector<std::pair<int, int>> AssociateByTime(std::span<const double> a,
                                                 std::span<const double> b, double max_dt);

}  // namespace alidade
