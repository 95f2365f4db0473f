// How long the parts of the pipeline take, on frames of one recording.
#pragma once

#include "bench/measure/recording.h"
#include "bench/measure/result.h"

namespace alidade::bench {

Section BenchFeatures(const Recording& recording);
Section BenchRansac(const Recording& recording);
Section BenchBundle(const Recording& recording);
Section BenchFrame(const Recording& recording);
Section BenchPlace(const Recording& recording);

}  // namespace alidade::bench
