// What leaving out movers costs the one who waits for poses.
#pragma once

#include <memory>
#include <vector>

#include "alidade/slam.h"
#include "bench/dynamic/scene.h"
#include "bench/measure/result.h"

namespace alidade::bench {

// Threaded, at the recording's own rate, the modes in turns; at most the first 300 frames. No
// detector: no `full`. `of`: the recording. `u`: gains the reference's milliseconds, taken in turns
// with the runs.
Table BenchDynamicLive(const DynamicScene& scene, const Case& of, const SlamSettings& settings,
                       const std::shared_ptr<Detector>& detector, std::vector<double>& u);

}  // namespace alidade::bench
