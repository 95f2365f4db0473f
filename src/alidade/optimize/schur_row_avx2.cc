// Compiled with AVX2 and run only where the processor has it: see cpu.h.
#include "alidade/optimize/schur_row.h"

#ifdef ALIDADE_AVX2
#include <immintrin.h>

namespace alidade {
namespace {

constexpr int kRows = 6, kRank = 3;

// Two columns of a block are three vectors of four numbers:
//   rows 0…3 of the first | rows 4, 5 of the first, rows 0, 1 of the second | rows 2…5 of the
//   second.
struct Column {  // of A, arranged to be multiplied with each of the three
  __m256d first, both, second;
};

Column Arranged(const double* column) {
  const __m256d upper = _mm256_loadu_pd(column), lower = _mm256_loadu_pd(column + 2);
  return {upper, _mm256_permute2f128_pd(lower, upper, 0x21), lower};
}

inline void Subtract(__m256d& sum, __m256d a, __m256d b) {
  sum = _mm256_sub_pd(sum, _mm256_mul_pd(a, b));  // rounded twice, as without AVX
}

}  // namespace

void SubtractRow4(const double* a, const double* b, const int* places, int count, double* blocks) {
  const Column columns[kRank] = {Arranged(a), Arranged(a + kRows), Arranged(a + 2 * kRows)};
  for (int n = 0; n < count; ++n, b += kRank * kRows) {
    double* block = blocks + static_cast<long>(places[n]) * kRows * kRows;
    for (int j = 0; j < kRows; j += 2) {
      double* to = block + j * kRows;
      __m256d first = _mm256_loadu_pd(to), both = _mm256_loadu_pd(to + 4),
              second = _mm256_loadu_pd(to + 8);
#pragma GCC unroll 3
      for (int k = 0; k < kRank; ++k) {
        const __m256d b0 = _mm256_broadcast_sd(b + k * kRows + j);
        const __m256d b1 = _mm256_broadcast_sd(b + k * kRows + j + 1);
        Subtract(first, columns[k].first, b0);
        Subtract(both, columns[k].both, _mm256_blend_pd(b0, b1, 0b1100));
        Subtract(second, columns[k].second, b1);
      }
      _mm256_storeu_pd(to, first);
      _mm256_storeu_pd(to + 4, both);
      _mm256_storeu_pd(to + 8, second);
    }
  }
}

}  // namespace alidade
#endif
