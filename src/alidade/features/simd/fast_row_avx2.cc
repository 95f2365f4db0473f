// Compiled with AVX2 and run only where the processor has it: see cpu.h.
#include "alidade/features/simd/fast_row.h"

#ifdef ALIDADE_AVX2
#include <immintrin.h>

#include <cstddef>

namespace alidade {
namespace {

constexpr int kCircle = 16, kLanes = 32;
constexpr int kCircleX[kCircle] = {0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1};
constexpr int kCircleY[kCircle] = {-3, -3, -2, -1, 0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3};

inline __m256i Load(const uint8_t* p) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p));
}
inline __m256i Min(__m256i a, __m256i b) { return _mm256_min_epu8(a, b); }
inline __m256i Max(__m256i a, __m256i b) { return _mm256_max_epu8(a, b); }
inline __m256i Minus(__m256i a, __m256i b) { return _mm256_subs_epu8(a, b); }  // at least 0

inline bool AnyAbove(__m256i values, __m256i threshold) {
  const __m256i above = Minus(values, threshold);
  return _mm256_testz_si256(above, above) == 0;
}

// As in fast.cc. Unrolled, or the compiler would keep the arrays in memory.
template <bool bright>
inline __m256i BestRun(const uint8_t* p, ptrdiff_t stride) {
  const auto weaker = [](__m256i a, __m256i b) { return bright ? Min(a, b) : Max(a, b); };
  const auto stronger = [](__m256i a, __m256i b) { return bright ? Max(a, b) : Min(a, b); };
  __m256i d[kCircle], two[kCircle / 2], four[kCircle / 2];
#pragma GCC unroll 16
  for (int k = 0; k < kCircle; ++k) d[k] = Load(p + kCircleY[k] * stride + kCircleX[k]);
#pragma GCC unroll 8
  for (int i = 0; i < kCircle / 2; ++i) two[i] = weaker(d[2 * i + 1], d[(2 * i + 2) % kCircle]);
#pragma GCC unroll 8
  for (int i = 0; i < kCircle / 2; ++i) four[i] = weaker(two[i], two[(i + 1) % 8]);
  __m256i best = _mm256_set1_epi8(bright ? 0 : -1);
#pragma GCC unroll 8
  for (int i = 0; i < kCircle / 2; ++i) {
    const __m256i eight = weaker(four[i], four[(i + 2) % 8]);
    best = stronger(best, weaker(eight, stronger(d[2 * i], d[(2 * i + 9) % kCircle])));
  }
  return best;
}

inline __m256i ScoresOf(const uint8_t* p, ptrdiff_t stride, __m256i threshold) {
  const __m256i centre = Load(p), zero = _mm256_setzero_si256();
  // Nine contiguous pixels contain the top or bottom and the left or right pixel.
  const __m256i top = Load(p - 3 * stride), right = Load(p + 3);
  const __m256i bottom = Load(p + 3 * stride), left = Load(p - 3);
  const bool bright = AnyAbove(Minus(Min(Max(top, bottom), Max(left, right)), centre), threshold);
  const bool dark = AnyAbove(Minus(centre, Max(Min(top, bottom), Min(left, right))), threshold);
  __m256i best = zero;
  if (bright) best = Minus(BestRun<true>(p, stride), centre);
  if (dark) best = Max(best, Minus(centre, BestRun<false>(p, stride)));
  const __m256i none = _mm256_cmpeq_epi8(Minus(best, threshold), zero);
  return _mm256_andnot_si256(none, best);
}

}  // namespace

int FastRow32(const uint8_t* pixels, int first, int end, ptrdiff_t stride, uint8_t threshold,
              uint8_t* score, int* columns) {
  const __m256i over = _mm256_set1_epi8(static_cast<char>(threshold));
  const __m256i zero = _mm256_setzero_si256();
  int count = 0;
  for (int x = first; x < end; x += kLanes) {
    // The last block moves back to stay inside the row: pixels before x are known.
    const int x0 = x < end - kLanes ? x : end - kLanes;
    const __m256i scores = ScoresOf(pixels + x0, stride, over);
    uint32_t mask = ~static_cast<uint32_t>(_mm256_movemask_epi8(_mm256_cmpeq_epi8(scores, zero)));
    mask &= 0xffffffffu << (x - x0);
    if (mask == 0) continue;
    uint8_t values[kLanes];
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(values), scores);
    for (; mask != 0; mask &= mask - 1) {
      const int lane = __builtin_ctz(mask);
      score[x0 + lane] = values[lane];
      columns[count++] = x0 + lane;
    }
  }
  return count;
}

}  // namespace alidade
#endif
