// Semi-dense depth: how right, how much of it, and at what cost.
#pragma once

#include <string>
#include <vector>

#include "bench/bench.h"

namespace alidade::bench {

// A folder that holds several recordings (each with an rgb.txt) stands for all of them, in order of
// name. None given: the rendered room, desk and wall.
std::vector<std::string> SemiDenseSources(const std::vector<std::string>& given);

// On the first `frames` of a recording with depth; 0: as docs/benchmarks/semidense.md says.
Section BenchSemiDense(const std::string& source, int frames);

// Tracking with and without semi-dense mapping behind it, in turns, as a live caller meets them.
Table BenchSemiDenseLive(const std::string& source, int frames, std::vector<double>& u);

}  // namespace alidade::bench
