// Compiled with AVX2 and run only where the processor has it: see cpu.h.
#include "alidade/optimize/sighting_terms.h"

#ifdef ALIDADE_AVX2
#include <immintrin.h>

namespace alidade {
namespace {

typedef double Double4 __attribute__((vector_size(32)));

[[gnu::always_inline]] inline Double4 Sqrt(Double4 x) { return _mm256_sqrt_pd(x); }

}  // namespace
}  // namespace alidade

#include "alidade/optimize/sighting_formulas.h"

namespace alidade {
namespace {

// Rows become columns.
[[gnu::always_inline]] inline void Transpose(const Double4* in, Double4* out) {
  const __m256d a = _mm256_unpacklo_pd(in[0], in[1]), b = _mm256_unpackhi_pd(in[0], in[1]);
  const __m256d c = _mm256_unpacklo_pd(in[2], in[3]), d = _mm256_unpackhi_pd(in[2], in[3]);
  out[0] = _mm256_permute2f128_pd(a, c, 0x20);
  out[1] = _mm256_permute2f128_pd(b, d, 0x20);
  out[2] = _mm256_permute2f128_pd(a, c, 0x31);
  out[3] = _mm256_permute2f128_pd(b, d, 0x31);
}

// Numbers [4 n, 4 n + 4) of four rows.
[[gnu::always_inline]] inline void Load(const double* const* rows, int n, Double4* out) {
  Double4 in[4];
#pragma GCC unroll 4
  for (int i = 0; i < 4; ++i) in[i] = _mm256_loadu_pd(rows[i] + 4 * n);
  Transpose(in, out);
}

void EvaluateFour(const SightingLens& lens, const SightingPlace* places, bool derivatives,
                  SightingTerms* terms) {
  SightingLanes<Double4> lanes;
  const double* rows[4];
#pragma GCC unroll 4
  for (int i = 0; i < 4; ++i) rows[i] = places[i].camera;
  Double4 camera[12];
#pragma GCC unroll 3
  for (int n = 0; n < 3; ++n) Load(rows, n, camera + 4 * n);
#pragma GCC unroll 9
  for (int i = 0; i < 9; ++i) lanes.R[i] = camera[i];
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
    lanes.centre[i] = camera[9 + i];
    lanes.X[i] =
        Double4{places[0].point[i], places[1].point[i], places[2].point[i], places[3].point[i]};
  }
#pragma GCC unroll 4
  for (int i = 0; i < 4; ++i) rows[i] = places[i].seen;
  Load(rows, 0, lanes.seen);
  Load(rows, 1, lanes.seen + 4);
  Double4 q[kTermsSize];
  FillTerms(lens, lanes, derivatives, q);
  if (!derivatives) {
#pragma GCC unroll 4
    for (int n = 0; n < 4; ++n) terms[n].cost = q[kTermsCost][n];
    return;
  }
#pragma GCC unroll 8
  for (int i = 0; i < kTermsSize; i += 4) {
    Double4 out[4];
    Transpose(q + i, out);
    for (int n = 0; n < 4; ++n) _mm256_storeu_pd(reinterpret_cast<double*>(terms + n) + i, out[n]);
  }
}

}  // namespace

void EvaluateSightings4(const SightingLens& lens, const SightingPlace* places, int count,
                        bool derivatives, SightingTerms* terms) {
  for (int i = 0; i < count; i += 4) EvaluateFour(lens, places + i, derivatives, terms + i);
}

}  // namespace alidade
#endif
