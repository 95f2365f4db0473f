#include <array>
#include <cstring>
#include <opencv2/core/hal/intrin.hpp>

#include "alidade/semidense/simd/line_kernel.h"

namespace alidade {
namespace {

// OpenCV's universal intrinsics as lanes of the kernel.
struct FourLanes {
  using Floats = cv::v_float32x4;
  using Ints = cv::v_int32x4;
  using Halves = cv::v_int16x8;
  static constexpr int kLanes = 4;

  static Floats All(float x) { return cv::v_setall_f32(x); }
  static Ints All(int x) { return cv::v_setall_s32(x); }
  static Ints Iota() { return {0, 1, 2, 3}; }
  static Floats Load(const float* p) { return cv::v_load(p); }
  static Ints Load(const int* p) { return cv::v_load(p); }
  static void Store(float* p, const Floats& x) { cv::v_store(p, x); }
  static void Store(int* p, const Ints& x) { cv::v_store(p, x); }
  // Four bytes at each offset from `base`.
  static Ints Gather(const uint8_t* base, const Ints& offsets) {
    std::array<int, kLanes> at, values;
    cv::v_store(at.data(), offsets);
    for (int i = 0; i < kLanes; ++i) std::memcpy(&values[i], base + at[i], sizeof(int));
    return {values[0], values[1], values[2], values[3]};
  }
  static Floats AsMask(const Ints& x) { return cv::v_reinterpret_as_f32(x); }
  static int Mask(const Floats& x) { return cv::v_signmask(x); }
  static Ints FromMask(int bits) {
    const Ints each(1, 2, 4, 8);
    return (All(bits) & each) == each;
  }
  static Floats Choose(const Floats& mask, const Floats& a, const Floats& b) {
    return cv::v_select(mask, a, b);
  }
  static Ints Choose(const Floats& mask, const Ints& a, const Ints& b) {
    return cv::v_select(cv::v_reinterpret_as_s32(mask), a, b);
  }
  static Ints Choose(const Ints& mask, const Ints& a, const Ints& b) {
    return cv::v_select(mask, a, b);
  }
  template <typename T>
  static T Min(const T& a, const T& b) {
    return cv::v_min(a, b);
  }
  template <typename T>
  static T Max(const T& a, const T& b) {
    return cv::v_max(a, b);
  }
  static Floats Abs(const Floats& x) { return cv::v_abs(x); }
  static Floats Sqrt(const Floats& x) { return cv::v_sqrt(x); }
  static Ints Floor(const Floats& x) { return cv::v_floor(x); }
  static Ints Ceil(const Floats& x) { return cv::v_ceil(x); }
  static Ints Trunc(const Floats& x) { return cv::v_trunc(x); }
  static Floats ToFloats(const Ints& x) { return cv::v_cvt_f32(x); }
  static int LeastOf(const Ints& x) { return cv::v_reduce_min(x); }
  template <int bits>
  static Ints Left(const Ints& x) {
    return cv::v_shl<bits>(x);
  }
  template <int bits>
  static Ints Right(const Ints& x) {
    return cv::v_shr<bits>(x);
  }
  // kLanes numbers from the one with this index on.
  template <int first>
  static Ints From(const Ints* x) {
    return cv::v_extract<first % kLanes>(x[first / kLanes],
                                         x[first / kLanes + (first % kLanes > 0)]);
  }
  // Of both halves of each lane, with sign: a scalar product, a difference, and the half rounded
  // towards zero.
  static Ints Dot(const Ints& a, const Ints& b) { return cv::v_dotprod(Of(a), Of(b)); }
  static Ints Minus16(const Ints& a, const Ints& b) {
    return cv::v_reinterpret_as_s32(Of(a) - Of(b));
  }
  static Ints Half16(const Ints& x) {
    const Halves negative =
        cv::v_reinterpret_as_s16(cv::v_shr<15>(cv::v_reinterpret_as_u16(Of(x))));
    return cv::v_reinterpret_as_s32(cv::v_shr<1>(Of(x) + negative));
  }

 private:
  static Halves Of(const Ints& x) { return cv::v_reinterpret_as_s16(x); }
};

}  // namespace

void LineSearch4(const LinePair& pair, const LineQueries& queries, LineAnswers& answers) {
  LineKernel<FourLanes>(pair).Search(queries, answers);
}

}  // namespace alidade
