#include "alidade/optimize/sighting_terms.h"

#include "alidade/optimize/double2.h"
#include "alidade/optimize/sighting_formulas.h"

namespace alidade {
namespace {

void EvaluatePair(const SightingLens& lens, const SightingPlace& a, const SightingPlace& b,
                  bool derivatives, SightingTerms* terms) {
  SightingLanes<Double2> lanes;
  for (int i = 0; i < 9; ++i) lanes.R[i] = Double2{a.camera[i], b.camera[i]};
  for (int i = 0; i < 3; ++i) {
    lanes.centre[i] = Double2{a.camera[9 + i], b.camera[9 + i]};
    lanes.X[i] = Double2{a.point[i], b.point[i]};
  }
  for (int i = 0; i < 8; ++i) lanes.seen[i] = Double2{a.seen[i], b.seen[i]};
  Double2 q[kTermsSize];
  FillTerms(lens, lanes, derivatives, q);
  if (!derivatives) {
    for (int n = 0; n < 2; ++n) terms[n].cost = q[kTermsCost][n];
    return;
  }
  Double2* const first = reinterpret_cast<Double2*>(terms);
  Double2* const second = reinterpret_cast<Double2*>(terms + 1);
  for (int i = 0; i < kTermsSize / 2; ++i) {
    first[i] = Double2{q[2 * i][0], q[2 * i + 1][0]};
    second[i] = Double2{q[2 * i][1], q[2 * i + 1][1]};
  }
}

}  // namespace

void EvaluateSightings2(const SightingLens& lens, const SightingPlace* places, int count,
                        bool derivatives, SightingTerms* terms) {
  for (int i = 0; i < count; i += 2)
    EvaluatePair(lens, places[i], places[i + 1], derivatives, terms + i);
}

EvaluateSightings FastestEvaluateSightings() {
#ifdef ALIDADE_AVX2
  if (HasAvx2()) return EvaluateSightings4;
#endif
  return EvaluateSightings2;
}

}  // namespace alidade
