#include "alidade/features/shrink.h"

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <cstdint>
#include <opencv2/core/hal/intrin.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>
#if defined(__SSSE3__)
#include <tmmintrin.h>
#endif
#if defined(__SSSE3__) || defined(__aarch64__) || defined(__wasm_simd128__)
#define ALIDADE_PICK  // an instruction picks bytes of a vector by index
#endif

namespace alidade {

#ifdef ALIDADE_PICK
namespace {

constexpr int kWindowBytes = 16;  // bytes that a block of results picks from
constexpr int kMostTaps = 16;

constexpr uint8_t kPickZero = 0x80;  // the index that gives 0

// Byte i is bytes[index[i]], or 0 where index[i] is kPickZero. Other indices are 0 to 15.
cv::v_uint8x16 Pick(const cv::v_uint8x16& bytes, const cv::v_uint8x16& index) {
#if defined(__SSSE3__)
  return cv::v_uint8x16(_mm_shuffle_epi8(bytes.val, index.val));
#elif defined(__aarch64__)
  return cv::v_uint8x16(vqtbl1q_u8(bytes.val, index.val));
#else
  return cv::v_uint8x16(wasm_i8x16_swizzle(bytes.val, index.val));
#endif
}

// Pixels per result along one axis, rounded as in cv::resize.
double Factor(int pixels, int results) { return 1 / (static_cast<double>(results) / pixels); }

bool IsWhole(double factor) { return std::abs(factor - std::round(factor)) < DBL_EPSILON; }

// What is computed here: fractional factors from 1 to kMostTaps - 1. cv::resize has quick ways for
// whole ones.
bool Shrinks(cv::Size from, cv::Size to) {
  const double x = Factor(from.width, to.width), y = Factor(from.height, to.height);
  return std::min(x, y) >= 1 && std::max(x, y) <= kMostTaps - 1 && !(IsWhole(x) && IsWhole(y));
}

// Result i along one axis is the sum over k < taps of pixel first[i] + k times weight [i][k].
struct Axis {
  Axis(int results, int taps_in)
      : taps(taps_in), first(results), weights(static_cast<size_t>(results) * taps) {}
  float* WeightsOf(int i) { return weights.data() + static_cast<size_t>(i) * taps; }
  const float* WeightsOf(int i) const { return weights.data() + static_cast<size_t>(i) * taps; }

  int taps;
  std::vector<int> first;
  std::vector<float> weights;
};

// Shares of the result's area that the pixels have; those below a thousandth are left out. All
// expressions are rounded as in cv::resize.
Axis AreaAxis(int pixels, int results) {
  constexpr double kLeast = 1e-3;
  const double factor = Factor(pixels, results);
  Axis axis(results, std::min(pixels, static_cast<int>(std::ceil(factor)) + 1));
  for (int i = 0; i < results; ++i) {
    const double begin = i * factor, end = begin + factor;
    const double width = std::min(factor, pixels - begin);
    const int last = std::min(static_cast<int>(std::floor(end)), pixels - 1);
    const int whole = std::min(static_cast<int>(std::ceil(begin)), last);
    const bool partly = whole - begin > kLeast;  // the pixel before
    // The last results begin earlier, with weights 0, so that all taps are inside.
    axis.first[i] = std::min(partly ? whole - 1 : whole, pixels - axis.taps);
    float* weight = axis.WeightsOf(i);
    const auto weigh = [&](int pixel, double share) {
      weight[pixel - axis.first[i]] = static_cast<float>(share / width);
    };
    if (partly) weigh(whole - 1, whole - begin);
    for (int pixel = whole; pixel < last; ++pixel) weigh(pixel, 1);
    if (end - last > kLeast) weigh(last, std::min(std::min(end - last, 1.0), width));
  }
  return axis;
}

// Two pixels around the center of each result, in 1 / 2048, rounded.
Axis LinearAxis(int pixels, int results) {
  constexpr float kOne = 2048;
  const double factor = Factor(pixels, results);
  Axis axis(results, 2);
  for (int i = 0; i < results; ++i) {
    const auto place = static_cast<float>((i + 0.5) * factor - 0.5);
    axis.first[i] = static_cast<int>(std::floor(place));
    const float beyond = place - static_cast<float>(axis.first[i]);
    axis.WeightsOf(i)[0] = std::nearbyint((1 - beyond) * kOne);
    axis.WeightsOf(i)[1] = std::nearbyint(beyond * kOne);
  }
  return axis;
}

// The results of a row in blocks of `lanes`, the last of which may overlap the one before it. Each
// is picked from the kWindowBytes at `begin`.
class Blocks {
 public:
  // `first(i)`: byte of a row of `bytes` at which result i begins. Windows move by up to `moves`
  // bytes, and `reach` bytes after the first are picked as well. Empty: a window would not hold
  // them, or not fit into the row.
  template <typename First>
  Blocks(int results, int lanes, const First& first, int bytes, int moves, int reach)
      : results_(results), lanes_(lanes), begin_((results + lanes - 1) / lanes) {
    const int last_begin = bytes - moves - kWindowBytes;
    if (results < lanes || last_begin < 0) return;
    for (int b = 0; b < static_cast<int>(begin_.size()); ++b) {
      begin_[b] = std::min(first(ResultOf(b)), last_begin);
      if (first(ResultOf(b) + lanes - 1) - begin_[b] + reach >= kWindowBytes) return;
    }
    count_ = static_cast<int>(begin_.size());
  }
  int count() const { return count_; }
  int BeginOf(int b) const { return begin_[b]; }
  int ResultOf(int b) const { return std::min(b * lanes_, results_ - lanes_); }

 private:
  int results_, lanes_, count_ = 0;
  std::vector<int> begin_;  // bytes
};

// Sums along a row in the order of the taps.
class AreaRow {
 public:
  using Sum = float;
  AreaRow(int pixels, int results, int channels)
      : AreaRow(AreaAxis(pixels, results), pixels, results, channels) {}
  bool empty() const { return blocks_.count() == 0; }
  // Of two rows at once, which share weights.
  void operator()(std::array<const uint8_t*, 2> rows, std::array<float*, 2> sums) const {
    const float* weight = weights_.data();
    for (int b = 0; b < blocks_.count(); ++b) {
      int at = blocks_.BeginOf(b);
      const cv::v_uint8x16 picked = cv::v_load(picked_.data() + b * kWindowBytes);
      cv::v_float32x4 first = cv::v_setzero_f32(), second = first;
      for (int k = 0; k < taps_; ++k, at += channels_, weight += kLanes) {
        const cv::v_float32x4 share = cv::v_load(weight);
        const auto weighted = [&](const uint8_t* row) {
          const cv::v_uint8x16 pixels = Pick(cv::v_load(row + at), picked);
          return cv::v_cvt_f32(cv::v_reinterpret_as_s32(pixels)) * share;
        };
        first = first + weighted(rows[0]);
        second = second + weighted(rows[1]);
      }
      cv::v_store(sums[0] + blocks_.ResultOf(b), first);
      cv::v_store(sums[1] + blocks_.ResultOf(b), second);
    }
  }

 private:
  static constexpr int kLanes = 4;
  AreaRow(const Axis& axis, int pixels, int results, int channels)
      : channels_(channels),
        taps_(axis.taps),
        blocks_(
            results * channels, kLanes, [&](int r) { return ByteOf(axis, r); }, pixels * channels,
            (taps_ - 1) * channels, 0),
        picked_(static_cast<size_t>(blocks_.count()) * kWindowBytes, kPickZero),
        weights_(static_cast<size_t>(blocks_.count()) * taps_ * kLanes) {
    for (int i = 0; i < blocks_.count() * kLanes; ++i) {
      const int b = i / kLanes, lane = i % kLanes, result = blocks_.ResultOf(b) + lane;
      picked_[4 * i] = static_cast<uint8_t>(ByteOf(axis, result) - blocks_.BeginOf(b));
      const float* weights = axis.WeightsOf(result / channels);
      for (int k = 0; k < taps_; ++k) weights_[(b * taps_ + k) * kLanes + lane] = weights[k];
    }
  }
  int ByteOf(const Axis& axis, int result) const {
    return axis.first[result / channels_] * channels_ + result % channels_;
  }

  int channels_, taps_;
  Blocks blocks_;
  std::vector<uint8_t> picked_;  // [block][byte]
  std::vector<float> weights_;   // [block][tap][lane]
};

// Sums along a row of one channel, in 1 / 2^7 gray levels.
class LinearRow {
 public:
  using Sum = int16_t;
  LinearRow(int pixels, int results) : LinearRow(LinearAxis(pixels, results), pixels, results) {}
  bool empty() const { return blocks_.count() == 0; }
  void operator()(std::array<const uint8_t*, 2> rows, std::array<int16_t*, 2> sums) const {
    for (int b = 0; b < blocks_.count(); ++b) {
      const uint8_t* picked = picked_.data() + b * 2 * kWindowBytes;
      const int16_t* weight = weights_.data() + b * 2 * kLanes;
      const cv::v_uint8x16 left = cv::v_load(picked), right = cv::v_load(picked + kWindowBytes);
      const cv::v_int16x8 of_left = cv::v_load(weight), of_right = cv::v_load(weight + kLanes);
      for (int r = 0; r < 2; ++r) {
        const cv::v_uint8x16 window = cv::v_load(rows[r] + blocks_.BeginOf(b));
        const auto half = [&](const cv::v_uint8x16& index, const cv::v_int16x8& weights) {
          const cv::v_int16x8 pixels = cv::v_reinterpret_as_s16(Pick(window, index));
          return cv::v_shr<4>(cv::v_dotprod(pixels, weights));
        };
        cv::v_store(sums[r] + blocks_.ResultOf(b),
                    cv::v_pack(half(left, of_left), half(right, of_right)));
      }
    }
  }

 private:
  static constexpr int kLanes = 8;
  LinearRow(const Axis& axis, int pixels, int results)
      : blocks_(
            IsInside(axis, pixels) ? results : 0, kLanes, [&](int r) { return axis.first[r]; },
            pixels, 0, 1),
        picked_(static_cast<size_t>(blocks_.count()) * 2 * kWindowBytes, kPickZero),
        weights_(static_cast<size_t>(blocks_.count()) * 2 * kLanes) {
    for (int i = 0; i < blocks_.count() * kLanes; ++i) {
      const int b = i / kLanes, result = blocks_.ResultOf(b) + i % kLanes;
      const int index = axis.first[result] - blocks_.BeginOf(b);
      picked_[4 * i] = static_cast<uint8_t>(index);
      picked_[4 * i + 2] = static_cast<uint8_t>(index + 1);
      for (int k = 0; k < 2; ++k)
        weights_[2 * i + k] = static_cast<int16_t>(axis.WeightsOf(result)[k]);
    }
  }
  // Not for factors close to 1, where the last center may be rounded to the last pixel.
  static bool IsInside(const Axis& axis, int pixels) {
    return axis.first.front() >= 0 && axis.first.back() + 1 < pixels;
  }

  Blocks blocks_;
  std::vector<uint8_t> picked_;   // [block][byte]: two bytes of each lane
  std::vector<int16_t> weights_;  // [block][lane][tap]
};

// Rounds half to even, for 0 <= v < 2^22: the sum with 1.5 * 2^23 has no bits after the point.
cv::v_int32x4 Rounded(const cv::v_float32x4& v) {
  const cv::v_float32x4 large = cv::v_setall_f32(12582912);
  return cv::v_reinterpret_as_s32(v + large) - cv::v_reinterpret_as_s32(large);
}

constexpr int kColumnsAtOnce = 8;  // results at once, down the columns

// Calls eight(x) for blocks that cover [0, count), count >= kColumnsAtOnce; the last may overlap.
template <typename Eight>
void ForEachStep(int count, uint8_t* out, const Eight& eight) {
  for (int x = 0; x < count; x += kColumnsAtOnce) {
    const int x0 = std::min(x, count - kColumnsAtOnce);
    cv::v_pack_u_store(out + x0, eight(x0));
  }
}

template <typename Sum>
using Lines = std::array<const Sum*, kMostTaps>;  // sums along each row

// Sums down the columns, rounded.
void SumDown(const Lines<float>& lines, const float* weights, int taps, int count, uint8_t* out) {
  const auto four = [&](int x) {
    cv::v_float32x4 sum = cv::v_load(lines[0] + x) * cv::v_setall_f32(weights[0]);
    for (int k = 1; k < taps; ++k)
      sum = sum + cv::v_load(lines[k] + x) * cv::v_setall_f32(weights[k]);
    return Rounded(sum);
  };
  ForEachStep(count, out, [&](int x) { return cv::v_pack(four(x), four(x + kColumnsAtOnce / 2)); });
}

void SumDown(const Lines<int16_t>& lines, const float* weights, int, int count, uint8_t* out) {
  const cv::v_int16x8 above = cv::v_setall_s16(static_cast<int16_t>(weights[0]));
  const cv::v_int16x8 below = cv::v_setall_s16(static_cast<int16_t>(weights[1]));
  ForEachStep(count, out, [&](int x) {
    const cv::v_int16x8 sum = cv::v_mul_hi(cv::v_load(lines[0] + x), above) +
                              cv::v_mul_hi(cv::v_load(lines[1] + x), below);
    return cv::v_shr<2>(sum + cv::v_setall_s16(2));
  });
}

// The sums along the last rows are kept: the next result begins with them.
template <typename Row>
void Shrink(const cv::Mat& image, const Row& along, const Axis& down, cv::Mat& small) {
  const int count = small.cols * small.channels(), kept = down.taps + 1;
  std::vector<typename Row::Sum> sums(static_cast<size_t>(count) * kept);
  std::array<int, kMostTaps + 1> row_of;
  row_of.fill(-1);
  Lines<typename Row::Sum> lines{};
  const auto line_of = [&](int row) {
    return sums.data() + static_cast<size_t>(row % kept) * count;
  };
  for (int y = 0; y < small.rows; ++y) {
    for (int k = 0; k < down.taps; ++k) {
      const int row = std::min(down.first[y] + k, image.rows - 1);
      if (row_of[row % kept] != row) {
        const int next = std::min(row + 1, image.rows - 1);
        along({image.ptr<uint8_t>(row), image.ptr<uint8_t>(next)}, {line_of(row), line_of(next)});
        row_of[row % kept] = row;
        row_of[next % kept] = next;
      }
      lines[k] = line_of(row);
    }
    SumDown(lines, down.WeightsOf(y), down.taps, count, small.ptr<uint8_t>(y));
  }
}

}  // namespace
#endif

cv::Mat ShrinkArea(const cv::Mat& image, cv::Size size) {
  cv::Mat small;
#ifdef ALIDADE_PICK
  if (image.depth() == CV_8U && size.width * image.channels() >= kColumnsAtOnce &&
      Shrinks(image.size(), size)) {
    const AreaRow along(image.cols, size.width, image.channels());
    if (!along.empty()) {
      small.create(size, image.type());
      Shrink(image, along, AreaAxis(image.rows, size.height), small);
      return small;
    }
  }
#endif
  cv::resize(image, small, size, 0, 0, cv::INTER_AREA);
  return small;
}

cv::Mat ShrinkLinear(const cv::Mat& image, cv::Size size, cv::Mat memory) {
#ifdef ALIDADE_PICK
  if (image.type() == CV_8UC1 && Shrinks(image.size(), size)) {
    const LinearRow along(image.cols, size.width);
    if (!along.empty()) {
      memory.create(size, image.type());
      Shrink(image, along, LinearAxis(image.rows, size.height), memory);
      return memory;
    }
  }
#endif
  cv::resize(image, memory, size, 0, 0, cv::INTER_LINEAR);
  return memory;
}

}  // namespace alidade
