#include "alidade/features/shrink.h"

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "alidade/features/pick.h"

namespace alidade {
namespace {

// Pixels per result along one axis, rounded as in cv::resize.
double Factor(int pixels, int results) { return 1 / (static_cast<double>(results) / pixels); }

bool IsWhole(double factor) { return std::abs(factor - std::round(factor)) < DBL_EPSILON; }

// What is computed here: fractional factors of at least 1. cv::resize has quick ways for others.
bool Shrinks(cv::Size from, cv::Size to) {
  const double x = Factor(from.width, to.width), y = Factor(from.height, to.height);
  return x >= 1 && y >= 1 && !(IsWhole(x) && IsWhole(y));
}

#ifdef ALIDADE_PICK

constexpr int kWindowBytes = 16;  // bytes that a block of results picks from
constexpr int kRounding = 11;     // bits after the point of the weights of linear interpolation

// Result i along one axis is the sum over k < taps of pixel first[i] + k times weight [i][k].
template <typename Weight>
struct Axis {
  Axis(int results, int taps_in)
      : taps(taps_in), first(results), weights(static_cast<size_t>(results) * taps) {}
  Weight* WeightsOf(int i) { return weights.data() + static_cast<size_t>(i) * taps; }
  const Weight* WeightsOf(int i) const { return weights.data() + static_cast<size_t>(i) * taps; }

  int taps;
  std::vector<int> first;
  std::vector<Weight> weights;
};

// Shares of the result's area that the pixels have; those below a thousandth are left out. All
// expressions are rounded as in cv::resize.
Axis<float> AreaAxis(int pixels, int results) {
  constexpr double kLeast = 1e-3;
  const double factor = Factor(pixels, results);
  Axis<float> axis(results, std::min(pixels, static_cast<int>(std::ceil(factor)) + 1));
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

// Two pixels around the center of each result, in 1 / 2^kRounding.
Axis<int16_t> LinearAxis(int pixels, int results) {
  const double factor = Factor(pixels, results);
  Axis<int16_t> axis(results, 2);
  for (int i = 0; i < results; ++i) {
    const auto place = static_cast<float>((i + 0.5) * factor - 0.5);
    axis.first[i] = static_cast<int>(std::floor(place));
    const float beyond = place - static_cast<float>(axis.first[i]);
    axis.WeightsOf(i)[0] = static_cast<int16_t>(std::lrint((1 - beyond) * (1 << kRounding)));
    axis.WeightsOf(i)[1] = static_cast<int16_t>(std::lrint(beyond * (1 << kRounding)));
  }
  return axis;
}

// A row in blocks of `lanes` results, the last of which may overlap the one before it. A block's
// results are picked from the kWindowBytes bytes at `begin`.
struct Blocks {
  int lanes = 0;
  std::vector<int> result, begin;  // the first result; bytes
  std::vector<uint8_t> index;      // [block][lane]: byte in the window
  int size() const { return static_cast<int>(result.size()); }
};

// `first`: byte of a row of `bytes` at which each result begins. Windows move by up to `moves`
// bytes, and `reach` bytes after the first are picked as well. Empty: a window would not hold them,
// or not fit into the row.
Blocks CutIntoBlocks(const std::vector<int>& first, int bytes, int lanes, int moves, int reach) {
  Blocks blocks;
  blocks.lanes = lanes;
  const int results = static_cast<int>(first.size()), last_begin = bytes - moves - kWindowBytes;
  if (results < lanes || last_begin < 0) return blocks;
  for (int at = 0; at < results; at += lanes) {
    const int result = std::min(at, results - lanes);
    const int begin = std::min(first[result], last_begin);
    for (int i = result; i < result + lanes; ++i) {
      const int index = first[i] - begin;
      if (index + reach >= kWindowBytes) return {};
      blocks.index.push_back(static_cast<uint8_t>(index));
    }
    blocks.result.push_back(result);
    blocks.begin.push_back(begin);
  }
  return blocks;
}

// Sums along a row in the order of the taps.
class AreaRow {
 public:
  using Sum = float;
  AreaRow(int pixels, int results, int channels) : channels_(channels) {
    const Axis<float> axis = AreaAxis(pixels, results);
    taps_ = axis.taps;
    std::vector<int> first(static_cast<size_t>(results) * channels);
    for (int r = 0; r < results * channels; ++r)
      first[r] = axis.first[r / channels] * channels + r % channels;
    blocks_ = CutIntoBlocks(first, pixels * channels, kLanes, (taps_ - 1) * channels, 0);
    for (const uint8_t i : blocks_.index)
      picked_.insert(picked_.end(), {i, kPickZero, kPickZero, kPickZero});
    for (const int result : blocks_.result) {
      for (int k = 0; k < taps_; ++k) {
        for (int r = result; r < result + kLanes; ++r)
          weights_.push_back(axis.WeightsOf(r / channels)[k]);
      }
    }
  }
  bool empty() const { return blocks_.size() == 0; }
  // Of two rows at once, which share weights.
  void operator()(std::array<const uint8_t*, 2> rows, std::array<float*, 2> sums) const {
    const float* weight = weights_.data();
    for (int b = 0; b < blocks_.size(); ++b) {
      int at = blocks_.begin[b];
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
      cv::v_store(sums[0] + blocks_.result[b], first);
      cv::v_store(sums[1] + blocks_.result[b], second);
    }
  }

 private:
  static constexpr int kLanes = 4;
  int channels_, taps_ = 0;
  Blocks blocks_;
  std::vector<uint8_t> picked_;  // [block][byte]
  std::vector<float> weights_;   // [block][tap][lane]
};

// Sums along a row of one channel, in 1 / 2^7 gray levels.
class LinearRow {
 public:
  using Sum = int16_t;
  LinearRow(int pixels, int results) {
    const Axis<int16_t> axis = LinearAxis(pixels, results);
    if (axis.first.front() < 0 || axis.first.back() + 1 >= pixels) return;  // factors close to 1
    blocks_ = CutIntoBlocks(axis.first, pixels, kLanes, 0, 1);
    for (const uint8_t i : blocks_.index)
      picked_.insert(picked_.end(), {i, kPickZero, static_cast<uint8_t>(i + 1), kPickZero});
    for (const int result : blocks_.result)
      weights_.insert(weights_.end(), axis.WeightsOf(result), axis.WeightsOf(result + kLanes));
  }
  bool empty() const { return blocks_.size() == 0; }
  void operator()(std::array<const uint8_t*, 2> rows, std::array<int16_t*, 2> sums) const {
    for (int b = 0; b < blocks_.size(); ++b) {
      const uint8_t* picked = picked_.data() + b * 2 * kWindowBytes;
      const int16_t* weight = weights_.data() + b * 2 * kLanes;
      const cv::v_uint8x16 left = cv::v_load(picked), right = cv::v_load(picked + kWindowBytes);
      const cv::v_int16x8 of_left = cv::v_load(weight), of_right = cv::v_load(weight + kLanes);
      for (int r = 0; r < 2; ++r) {
        const cv::v_uint8x16 window = cv::v_load(rows[r] + blocks_.begin[b]);
        const auto half = [&](const cv::v_uint8x16& index, const cv::v_int16x8& weights) {
          const cv::v_int16x8 pixels = cv::v_reinterpret_as_s16(Pick(window, index));
          return cv::v_shr<4>(cv::v_dotprod(pixels, weights));
        };
        cv::v_store(sums[r] + blocks_.result[b],
                    cv::v_pack(half(left, of_left), half(right, of_right)));
      }
    }
  }

 private:
  static constexpr int kLanes = 8;
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

// Sums down the columns, rounded; lines[k]: sums along row k.
void SumDown(const std::vector<const float*>& lines, const float* weights, int count,
             uint8_t* out) {
  const auto four = [&](int x) {
    cv::v_float32x4 sum = cv::v_load(lines[0] + x) * cv::v_setall_f32(weights[0]);
    for (size_t k = 1; k < lines.size(); ++k)
      sum = sum + cv::v_load(lines[k] + x) * cv::v_setall_f32(weights[k]);
    return Rounded(sum);
  };
  ForEachStep(count, out, [&](int x) { return cv::v_pack(four(x), four(x + kColumnsAtOnce / 2)); });
}

void SumDown(const std::vector<const int16_t*>& lines, const int16_t* weights, int count,
             uint8_t* out) {
  const cv::v_int16x8 above = cv::v_setall_s16(weights[0]), below = cv::v_setall_s16(weights[1]);
  ForEachStep(count, out, [&](int x) {
    const cv::v_int16x8 sum = cv::v_mul_hi(cv::v_load(lines[0] + x), above) +
                              cv::v_mul_hi(cv::v_load(lines[1] + x), below);
    return cv::v_shr<2>(sum + cv::v_setall_s16(2));
  });
}

// The sums along the last rows are kept: the next result begins with them.
template <typename Row, typename Weight>
void Shrink(const cv::Mat& image, const Row& along, const Axis<Weight>& down, cv::Mat& small) {
  const int count = small.cols * small.channels(), kept = down.taps + 1;
  std::vector<typename Row::Sum> sums(static_cast<size_t>(count) * kept);
  std::vector<int> row_of(kept, -1);
  std::vector<const typename Row::Sum*> lines(down.taps);
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
    SumDown(lines, down.WeightsOf(y), count, small.ptr<uint8_t>(y));
  }
}

#endif

}  // namespace

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
