// A map of tens of thousands of keyframes: what it costs to hold, change, keep and find oneself in.
#pragma once

#include "bench/measure/result.h"

namespace alidade::bench {

// A generated map of `keyframes` keyframes along a straight way, each of 1000 keypoints
// that all show landmarks, each landmark seen by ten: a hundred landmarks for each keyframe.
Section BenchLargeMap(int keyframes);

}  // namespace alidade::bench
