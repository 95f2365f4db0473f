// Compiled with AVX2 and run only where the processor has it: see cpu.h.
#include "alidade/features/simd/smooth_row.h"

#ifdef ALIDADE_AVX2
#include <immintrin.h>

namespace alidade {
namespace {

constexpr int kLanes = 16;  // sums of 16 bits

inline __m256i Load(const uint8_t* p) {
  return _mm256_cvtepu8_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p)));
}
inline __m256i Load(const uint16_t* p) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p));
}
inline void Store(uint16_t* p, __m256i v) { _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), v); }
inline __m256i Plus(__m256i a, __m256i b) { return _mm256_add_epi16(a, b); }
inline __m256i Twice(__m256i a) { return _mm256_add_epi16(a, a); }

// Two results of 16 lanes as 32 bytes.
inline void StoreBytes(uint8_t* p, __m256i low, __m256i high) {
  const __m256i mixed = _mm256_packus_epi16(low, high);  // packs each half of 128 bits
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), _mm256_permute4x64_epi64(mixed, 0xd8));
}

inline int StartOfBlock(int x, int width, int step) {
  return x + step <= width ? x : width - step;  // the last block may overlap
}

inline void RepeatRim(uint16_t* sums, int width) {
  Store(sums - kLanes, _mm256_set1_epi16(static_cast<short>(sums[0])));
  Store(sums + width, _mm256_set1_epi16(static_cast<short>(sums[width - 1])));
}

}  // namespace

void BinomialRowAvx2(const uint8_t* above, const uint8_t* here, const uint8_t* below, int width,
                     uint16_t* sums, uint8_t* out) {
  for (int column = 0; column < width; column += kLanes) {
    const int x = StartOfBlock(column, width, kLanes);
    Store(sums + x, Plus(Plus(Load(above + x), Load(below + x)), Twice(Load(here + x))));
  }
  RepeatRim(sums, width);
  const __m256i half = _mm256_set1_epi16(8);
  const auto mean = [&](const uint16_t* s) {
    const __m256i sum = Plus(Plus(Load(s - 1), Load(s + 1)), Twice(Load(s)));
    return _mm256_srli_epi16(Plus(sum, half), 4);
  };
  for (int column = 0; column < width; column += 2 * kLanes) {
    const int x = StartOfBlock(column, width, 2 * kLanes);
    StoreBytes(out + x, mean(sums + x), mean(sums + x + kLanes));
  }
}

void BoxColumnsAvx2(const uint16_t* before, const uint8_t* comes, const uint8_t* goes, int width,
                    uint16_t* sums) {
  for (int column = 0; column < width; column += kLanes) {
    const int x = StartOfBlock(column, width, kLanes);
    const __m256i more = Plus(Load(before + x), Load(comes + x));
    Store(sums + x, _mm256_sub_epi16(more, Load(goes + x)));
  }
}

void BoxRowAvx2(uint16_t* sums, int width, uint8_t* out) {
  RepeatRim(sums, width);
  const __m256i tenth = _mm256_set1_epi16(10 << 8);  // sum * 10 >> 8 = sum * (10 << 8) >> 16
  const auto mean = [&](const uint16_t* s) {
    const __m256i outer = Plus(Load(s - 2), Load(s + 2)), inner = Plus(Load(s - 1), Load(s + 1));
    return _mm256_mulhi_epu16(Plus(Plus(outer, inner), Load(s)), tenth);
  };
  for (int column = 0; column < width; column += 2 * kLanes) {
    const int x = StartOfBlock(column, width, 2 * kLanes);
    StoreBytes(out + x, mean(sums + x), mean(sums + x + kLanes));
  }
}

}  // namespace alidade
#endif
