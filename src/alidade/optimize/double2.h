// Two doubles in one SSE2, NEON or WebAssembly register, with bitwise the same results as scalar
// code. The vector types of GCC and clang support arithmetic, comparisons (lanes of all ones or
// zeros) and `?:`.
#pragma once

#include <cmath>
#ifdef __SSE2__
#include <emmintrin.h>
#elif defined(__wasm_simd128__)
#include <wasm_simd128.h>
#endif

namespace alidade {

typedef double Double2 __attribute__((vector_size(16)));
typedef long long Mask2 __attribute__((vector_size(16)));

inline Double2 Both(double x) { return Double2{x, x}; }
inline double Sum(Double2 x) { return x[0] + x[1]; }
inline Double2 Min(Double2 a, Double2 b) { return a < b ? a : b; }
inline Double2 Max(Double2 a, Double2 b) { return a > b ? a : b; }
inline Double2 Sqrt(Double2 x) {
#ifdef __SSE2__
  return _mm_sqrt_pd(x);
#elif defined(__wasm_simd128__)
  return reinterpret_cast<Double2>(wasm_f64x2_sqrt(reinterpret_cast<v128_t>(x)));
#else
  return Double2{std::sqrt(x[0]), std::sqrt(x[1])};
#endif
}

}  // namespace alidade
