// What each sighting adds to the normal equations of bundle adjustment (bundle_linearise.h),
// several at once. All versions give the same bits.
#pragma once

#include "alidade/base/cpu.h"

namespace alidade {

// Intrinsics without its functions, for files that are compiled for other processors.
struct SightingLens {
  double fx, fy, cx, cy, bf;
};

struct SightingPlace {   // where the numbers of a sighting are
  const double* seen;    // u to trust of BundleSighting
  const double* camera;  // BundleCamera: R by columns, centre
  const double* point;   // in the world frame
};

struct alignas(16) SightingTerms {
  // CameraBlock's numbers: B'WB as 6, C = [Y]x B'WB as 9, C [Y]x' as 6, B'Wr, Y × B'Wr; then 0. W
  // contains trust and the loss's weight at this state (iteratively reweighted least squares).
  double camera[28];
  double Y[3];  // point minus camera center, world axes
  double cost;  // weighted loss; infinite if the point is behind the camera
};

// Sightings are evaluated in groups of this size: `places` and `terms` have room for whole groups,
// and all places of the last group are valid.
inline constexpr int kSightingGroup = 4;

// Without `derivatives` only the costs of `terms` are set.
using EvaluateSightings = void (*)(const SightingLens& lens, const SightingPlace* places, int count,
                                   bool derivatives, SightingTerms* terms);

// Two sightings at once.
void EvaluateSightings2(const SightingLens& lens, const SightingPlace* places, int count,
                        bool derivatives, SightingTerms* terms);

#ifdef ALIDADE_AVX2
// Four at once, with AVX2.
void EvaluateSightings4(const SightingLens& lens, const SightingPlace* places, int count,
                        bool derivatives, SightingTerms* terms);
#endif

// The fastest one that this processor admits.
EvaluateSightings FastestEvaluateSightings();

}  // namespace alidade
