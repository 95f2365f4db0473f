// How often a value was how large.
#pragma once

#include <string>
#include <vector>

namespace alidade {

// Bars from 0 to what 99 % are below, the last with all that is above; a line at the median, a
// dashed one at the 95th percentile. None: an empty drawing.
std::string DrawHistogram(const std::vector<double>& values, const std::string& unit,
                          const std::string& label);

}  // namespace alidade
