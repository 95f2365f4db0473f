// Semi-dense depth: how right, how much of it, and at what cost.
#pragma once

#include <string>
#include <vector>

#include "bench/measure/result.h"

namespace alidade::bench {

// On the first `frames` of a recording with depth; 0: 200 rendered ones, 600 recorded ones.
Section BenchSemiDense(const std::string& source, int frames);

// Tracking with and without semi-dense mapping behind it, in turns, as a live caller meets them.
Table BenchSemiDenseLive(const std::string& source, int frames, std::vector<double>& u);

}  // namespace alidade::bench
