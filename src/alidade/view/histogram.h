// Histograms as SVG elements.
#pragma once

#include <string>
#include <vector>

namespace alidade {

// Bars from 0 to the 99th percentile; the last bar includes all larger values. A line marks the
// median, a dashed line the 95th percentile. Without values the drawing is empty.
std::string DrawHistogram(const std::vector<double>& values, const std::string& unit,
                          const std::string& label);

}  // namespace alidade
