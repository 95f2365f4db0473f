// Whether covariances of poses are as large as their errors.
#pragma once

#include "bench/measure/result.h"

namespace alidade::bench {

// Root mean square of error / standard deviation (1: right) of the motion between two frames a
// third of a second apart, over rendered recordings with `seeds` seeds from `first_seed` on: in the
// first two seconds of a map, and later.
Table CovarianceTable(int seeds, int first_seed);

}  // namespace alidade::bench
