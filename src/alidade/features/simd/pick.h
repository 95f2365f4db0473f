// Bytes of a vector picked by index, with the instruction that each processor has for it.
#pragma once

#include <opencv2/core/hal/intrin.hpp>
#if defined(__SSSE3__)
#include <tmmintrin.h>
#endif

#if defined(__SSSE3__) || defined(__aarch64__) || defined(__wasm_simd128__)
#define ALIDADE_PICK

namespace alidade {

inline constexpr uint8_t kPickZero = 0x80;  // the index that gives 0

// Byte i is bytes[index[i]], or 0 where index[i] is kPickZero. Other indices are 0 to 15.
inline cv::v_uint8x16 Pick(const cv::v_uint8x16& bytes, const cv::v_uint8x16& index) {
#if defined(__SSSE3__)
  return cv::v_uint8x16(_mm_shuffle_epi8(bytes.val, index.val));
#elif defined(__aarch64__)
  return cv::v_uint8x16(vqtbl1q_u8(bytes.val, index.val));
#else
  return cv::v_uint8x16(wasm_i8x16_swizzle(bytes.val, index.val));
#endif
}

}  // namespace alidade
#endif
