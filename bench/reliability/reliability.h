// Whether the probability of a pose (PoseQuality::probability) is right, on rendered recordings.
#pragma once

#include "bench/measure/result.h"

namespace alidade::bench {

// Recordings that change the place without a gap in time: three scenes in five pieces each, one
// camera and with depth, 320 × 240 and 640 × 480; a sixth each of them usual, blurred, dark, with
// people, at twice the speed, and noisy. Poses of low probability are kept, so that the whole range
// is seen, but become no keyframes. Right is a pose whose reference keyframe is of the same place,
// off from it by less than 3°, and with depth less than 0.1 m. Also the table of CovarianceTable().
// The first `seed` is `first_seed`.
Section BenchReliability(int seeds, int first_seed);

}  // namespace alidade::bench
