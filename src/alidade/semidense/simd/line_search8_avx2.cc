// Compiled with AVX2 and run only where the processor has it: see cpu.h.
#include "alidade/base/cpu.h"

#ifdef ALIDADE_AVX2
#include <immintrin.h>

#include "alidade/semidense/simd/line_kernel.h"

namespace alidade {
namespace {

struct Floats8 {
  __m256 v;
};
struct Ints8 {
  __m256i v;
};

inline Floats8 operator+(Floats8 a, Floats8 b) { return {_mm256_add_ps(a.v, b.v)}; }
inline Floats8 operator-(Floats8 a, Floats8 b) { return {_mm256_sub_ps(a.v, b.v)}; }
inline Floats8 operator*(Floats8 a, Floats8 b) { return {_mm256_mul_ps(a.v, b.v)}; }
inline Floats8 operator/(Floats8 a, Floats8 b) { return {_mm256_div_ps(a.v, b.v)}; }
inline Floats8 operator&(Floats8 a, Floats8 b) { return {_mm256_and_ps(a.v, b.v)}; }
inline Floats8 operator|(Floats8 a, Floats8 b) { return {_mm256_or_ps(a.v, b.v)}; }
inline Floats8 operator<(Floats8 a, Floats8 b) { return {_mm256_cmp_ps(a.v, b.v, _CMP_LT_OS)}; }
inline Floats8 operator>(Floats8 a, Floats8 b) { return {_mm256_cmp_ps(a.v, b.v, _CMP_GT_OS)}; }
inline Floats8 operator<=(Floats8 a, Floats8 b) { return {_mm256_cmp_ps(a.v, b.v, _CMP_LE_OS)}; }
inline Floats8 operator>=(Floats8 a, Floats8 b) { return {_mm256_cmp_ps(a.v, b.v, _CMP_GE_OS)}; }
inline Ints8 operator+(Ints8 a, Ints8 b) { return {_mm256_add_epi32(a.v, b.v)}; }
inline Ints8 operator-(Ints8 a, Ints8 b) { return {_mm256_sub_epi32(a.v, b.v)}; }
inline Ints8 operator*(Ints8 a, Ints8 b) { return {_mm256_mullo_epi32(a.v, b.v)}; }
inline Ints8 operator&(Ints8 a, Ints8 b) { return {_mm256_and_si256(a.v, b.v)}; }
inline Ints8 operator|(Ints8 a, Ints8 b) { return {_mm256_or_si256(a.v, b.v)}; }
inline Ints8 operator>(Ints8 a, Ints8 b) { return {_mm256_cmpgt_epi32(a.v, b.v)}; }
inline Ints8 operator==(Ints8 a, Ints8 b) { return {_mm256_cmpeq_epi32(a.v, b.v)}; }

// As FourLanes in line_search4.cc. Conversions to integers are those of OpenCV, whatever the value.
struct EightLanes {
  using Floats = Floats8;
  using Ints = Ints8;
  static constexpr int kLanes = 8;

  static Floats All(float x) { return {_mm256_set1_ps(x)}; }
  static Ints All(int x) { return {_mm256_set1_epi32(x)}; }
  static Ints Iota() { return {_mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7)}; }
  static Floats Load(const float* p) { return {_mm256_loadu_ps(p)}; }
  static Ints Load(const int* p) { return {_mm256_loadu_si256(Vector(p))}; }
  static void Store(float* p, Floats x) { _mm256_storeu_ps(p, x.v); }
  static void Store(int* p, Ints x) { _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), x.v); }
  static Ints Gather(const uint8_t* base, Ints offsets) {
    return {_mm256_i32gather_epi32(reinterpret_cast<const int*>(base), offsets.v, 1)};
  }
  static Floats AsMask(Ints x) { return {_mm256_castsi256_ps(x.v)}; }
  static int Mask(Floats x) { return _mm256_movemask_ps(x.v); }
  static Ints FromMask(int bits) {
    const Ints each{_mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128)};
    return (All(bits) & each) == each;
  }
  static Floats Choose(Floats mask, Floats a, Floats b) {
    return {_mm256_blendv_ps(b.v, a.v, mask.v)};
  }
  static Ints Choose(Floats mask, Ints a, Ints b) {
    return {_mm256_blendv_epi8(b.v, a.v, _mm256_castps_si256(mask.v))};
  }
  static Ints Choose(Ints mask, Ints a, Ints b) { return {_mm256_blendv_epi8(b.v, a.v, mask.v)}; }
  static Floats Min(Floats a, Floats b) { return {_mm256_min_ps(a.v, b.v)}; }
  static Floats Max(Floats a, Floats b) { return {_mm256_max_ps(a.v, b.v)}; }
  static Ints Min(Ints a, Ints b) { return {_mm256_min_epi32(a.v, b.v)}; }
  static Ints Max(Ints a, Ints b) { return {_mm256_max_epi32(a.v, b.v)}; }
  static Floats Abs(Floats x) {
    return {_mm256_and_ps(x.v, _mm256_castsi256_ps(_mm256_set1_epi32(0x7fffffff)))};
  }
  static Floats Sqrt(Floats x) { return {_mm256_sqrt_ps(x.v)}; }
  static Ints Floor(Floats x) {
    const __m256i near = _mm256_cvtps_epi32(x.v);
    return {_mm256_add_epi32(near, Above(_mm256_cvtepi32_ps(near), x.v))};
  }
  static Ints Ceil(Floats x) {
    const __m256i near = _mm256_cvtps_epi32(x.v);
    return {_mm256_sub_epi32(near, Above(x.v, _mm256_cvtepi32_ps(near)))};
  }
  static Ints Trunc(Floats x) { return {_mm256_cvttps_epi32(x.v)}; }
  static Floats ToFloats(Ints x) { return {_mm256_cvtepi32_ps(x.v)}; }
  static int LeastOf(Ints x) {
    __m128i least = _mm_min_epi32(_mm256_castsi256_si128(x.v), _mm256_extracti128_si256(x.v, 1));
    least = _mm_min_epi32(least, _mm_shuffle_epi32(least, 0x4e));
    return _mm_cvtsi128_si32(_mm_min_epi32(least, _mm_shuffle_epi32(least, 0xb1)));
  }
  template <int bits>
  static Ints Left(Ints x) {
    return {_mm256_slli_epi32(x.v, bits)};
  }
  template <int bits>
  static Ints Right(Ints x) {
    return {_mm256_srai_epi32(x.v, bits)};
  }
  template <int first>
  static Ints From(const Ints* x) {
    // Halves of vectors are shifted apart: those of `x` from lane 4 on are in between.
    const __m256i between = _mm256_permute2x128_si256(x[0].v, x[1].v, 0x21);
    if constexpr (first < 4) return {_mm256_alignr_epi8(between, x[0].v, 4 * first)};
    return {_mm256_alignr_epi8(x[1].v, between, 4 * (first % 4))};
  }
  static Ints Dot(Ints a, Ints b) { return {_mm256_madd_epi16(a.v, b.v)}; }
  static Ints Minus16(Ints a, Ints b) { return {_mm256_sub_epi16(a.v, b.v)}; }
  static Ints Half16(Ints x) {
    return {_mm256_srai_epi16(_mm256_add_epi16(x.v, _mm256_srli_epi16(x.v, 15)), 1)};
  }

 private:
  static const __m256i* Vector(const int* p) { return reinterpret_cast<const __m256i*>(p); }
  static __m256i Above(__m256 a, __m256 b) {
    return _mm256_castps_si256(_mm256_cmp_ps(a, b, _CMP_GT_OS));
  }
};

}  // namespace

void LineSearch8(const LinePair& pair, const LineQueries& queries, LineAnswers& answers) {
  LineKernel<EightLanes>(pair).Search(queries, answers);
}

}  // namespace alidade
#endif
