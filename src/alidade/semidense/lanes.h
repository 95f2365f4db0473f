// Four numbers at once, one per lane of a vector (OpenCV's universal intrinsics).
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core/hal/intrin.hpp>

namespace alidade {

using Floats = cv::v_float32x4;
using Ints = cv::v_int32x4;
inline constexpr int kLanes = 4;
template <typename T>
using Lanes = std::array<T, kLanes>;

inline Floats All(float x) { return cv::v_setall_f32(x); }
inline Ints All(int x) { return cv::v_setall_s32(x); }

// In lanes of all ones a, in lanes of zeros b.
inline Floats Choose(const Floats& mask, const Floats& a, const Floats& b) {
  return cv::v_select(mask, a, b);
}

inline constexpr int kFixed = 16;  // fractional bits of positions
inline Ints ToFixed(const Floats& x) {
  return cv::v_trunc(x * All(static_cast<float>(1 << kFixed)));
}

}  // namespace alidade
