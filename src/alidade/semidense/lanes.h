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

}  // namespace alidade
