// Depth of keypoints from the right image of a rectified stereo pair.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/core/hal/intrin.hpp>

#include "alidade/base/error.h"
#include "alidade/base/median.h"
#include "alidade/base/parallel.h"
#include "alidade/features/extractor.h"
#include "alidade/features/pyramid.h"

namespace alidade {
namespace {

constexpr int kMaxDistance = 75;        // Hamming distance, bits
constexpr float kRowTolerance = 2;      // pixels of the right keypoint's level
constexpr int kWindow = 5;              // half side of the compared windows, pixels of the level
constexpr int kSlide = 5;               // search range in either direction, pixels of the level
constexpr double kMinDisparity = 0.1;   // pixels; a smaller disparity is not a depth measurement
constexpr double kOutlier = 1.5 * 1.4;  // in medians of the SAD
constexpr int kPairedAtATime = 64;

// For each row, the right keypoints whose row is within the tolerance.
std::vector<std::vector<int>> RowTable(const Frame& right, int rows) {
  std::vector<std::vector<int>> table(rows);
  for (int i = 0; i < static_cast<int>(right.keypoints.size()); ++i) {
    const Keypoint& k = right.keypoints[i];
    const float reach = kRowTolerance * static_cast<float>(ScaleOfLevel(k.level));
    const int first = std::max(0, static_cast<int>(std::floor(k.y - reach)));
    const int last = std::min(rows - 1, static_cast<int>(std::ceil(k.y + reach)));
    for (int row = first; row <= last; ++row) table[row].push_back(i);
  }
  return table;
}

// A window row has 11 pixels and is read as 16; this masks the rest.
constexpr std::array<uint8_t, 16> kInWindow = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0};

int WindowSum(const cv::Mat& image, int x, int y) {
  const cv::v_uint8x16 inside = cv::v_load(kInWindow.data());
  cv::v_uint32x4 sum = cv::v_setzero_u32();
  for (int v = -kWindow; v <= kWindow; ++v) {
    const uint8_t* row = image.ptr<uint8_t>(y + v) + x - kWindow;
    sum = cv::v_dotprod_expand_fast(cv::v_load(row), inside, sum);
  }
  return static_cast<int>(cv::v_reduce_sum(sum));
}

// SAD of two windows after removing the difference of their means, since exposures may differ.
int WindowDifference(const cv::Mat& left, int xl, const cv::Mat& right, int xr, int y) {
  constexpr int kPixels = (2 * kWindow + 1) * (2 * kWindow + 1);
  const int offset = static_cast<int>(
      std::lround(static_cast<double>(WindowSum(left, xl, y) - WindowSum(right, xr, y)) / kPixels));
  // One of the two is zero; subtraction saturates at 0.
  const cv::v_uint8x16 from_left = cv::v_setall_u8(static_cast<uint8_t>(std::max(0, offset)));
  const cv::v_uint8x16 from_right = cv::v_setall_u8(static_cast<uint8_t>(std::max(0, -offset)));
  const cv::v_uint8x16 inside = cv::v_load(kInWindow.data());
  cv::v_uint32x4 sum = cv::v_setzero_u32();
  for (int v = -kWindow; v <= kWindow; ++v) {
    const cv::v_uint8x16 l = cv::v_load(left.ptr<uint8_t>(y + v) + xl - kWindow) - from_left;
    const cv::v_uint8x16 r = cv::v_load(right.ptr<uint8_t>(y + v) + xr - kWindow) - from_right;
    sum = cv::v_dotprod_expand_fast(cv::v_absdiff(l, r), inside, sum);
  }
  return static_cast<int>(cv::v_reduce_sum(sum));
}

// Sub-pixel alignment of the right window to the left one along the row: Gauss-Newton steps on the
// squared differences minus their mean (Lucas & Kanade 1981), with the left window's gradient.
// Returns the column in the right image; NaN if it moves too far or the window has no horizontal
// gradient.
double Align(const cv::Mat& left, int xl, const cv::Mat& right, double xr, int y) {
  constexpr int kSteps = 4;
  constexpr int kSide = 2 * kWindow + 1;
  constexpr double kFarthest = 1.5;  // pixels from the start, which is the best whole pixel
  constexpr double kLost = std::numeric_limits<double>::quiet_NaN();
  std::array<float, kSide * kSide> slope;
  float mean_slope = 0, strength = 0;
  for (int v = 0, i = 0; v < kSide; ++v) {
    const uint8_t* row = left.ptr<uint8_t>(y + v - kWindow) + xl - kWindow;
    for (int u = 0; u < kSide; ++u, ++i) {
      slope[i] = 0.5f * static_cast<float>(row[u + 1] - row[u - 1]);
      mean_slope += slope[i] / (kSide * kSide);
    }
  }
  for (float& s : slope) {
    s -= mean_slope;  // makes the result independent of a brightness offset
    strength += s * s;
  }
  if (strength < 1) return kLost;
  double x = xr;
  for (int step = 0; step < kSteps; ++step) {
    const int whole = static_cast<int>(std::floor(x));
    const float part = static_cast<float>(x - whole);
    if (whole < kWindow || whole + kWindow + 1 >= right.cols) return kLost;
    float sum = 0;
    for (int v = 0, i = 0; v < kSide; ++v) {
      const uint8_t* l = left.ptr<uint8_t>(y + v - kWindow) + xl - kWindow;
      const uint8_t* r = right.ptr<uint8_t>(y + v - kWindow) + whole - kWindow;
      for (int u = 0; u < kSide; ++u, ++i) {
        const float value = r[u] + part * static_cast<float>(r[u + 1] - r[u]);
        sum += slope[i] * (l[u] - value);
      }
    }
    x += sum / strength;
    if (!(std::abs(x - xr) <= kFarthest)) return kLost;
  }
  return x;
}

struct Disparity {
  double pixels = 0;    // of level 0
  int difference = -1;  // SAD; -1 = not found
};

Disparity Refine(const Frame& left, const Keypoint& k, const Frame& right, float right_x) {
  const cv::Mat& l = left.pyramid[k.level];
  const cv::Mat& r = right.pyramid[k.level];
  const double scale_x = static_cast<double>(left.image.cols) / l.cols;
  const double scale_y = static_cast<double>(left.image.rows) / l.rows;
  const int xl = static_cast<int>(std::lround(FromLevelZero(k.raw_x, scale_x)));
  const int y = static_cast<int>(std::lround(FromLevelZero(k.raw_y, scale_y)));
  const int xr = static_cast<int>(std::lround(FromLevelZero(right_x, scale_x)));
  constexpr int kRead = 16 - kWindow;  // columns read to the right of a window's center
  if (y < kWindow || y >= l.rows - kWindow || xl <= kWindow || xl >= l.cols - kRead) return {};
  if (xr < kWindow + kSlide || xr >= r.cols - kSlide - kRead) return {};
  std::array<int, 2 * kSlide + 1> difference;
  for (int s = -kSlide; s <= kSlide; ++s) {
    difference[s + kSlide] = WindowDifference(l, xl, r, xr + s, y);
  }
  const int best =
      static_cast<int>(std::min_element(difference.begin(), difference.end()) - difference.begin());
  if (best == 0 || best == 2 * kSlide) return {};
  const double aligned = Align(l, xl, r, xr + best - kSlide, y);
  if (!std::isfinite(aligned)) return {};
  return {(xl - aligned) * scale_x, difference[best]};
}

}  // namespace

void MatchStereo(const Frame& right, const Camera& camera, Frame& left) {
  if (left.pyramid.empty() || right.pyramid.empty()) ThrowUsage("stereo: both pyramids are needed");
  if (left.image.size() != right.image.size()) {
    ThrowInput("stereo: left and right image differ in size");
  }
  const std::vector<std::vector<int>> table = RowTable(right, left.image.rows);
  const double bf = camera.bf();
  const double max_disparity = camera.fx;  // a point nearer than the baseline is not seen by both
  const int count = static_cast<int>(left.keypoints.size());
  std::vector<Disparity> found(left.keypoints.size());
  ParallelFor((count + kPairedAtATime - 1) / kPairedAtATime, [&](int chunk) {
    for (int i = chunk * kPairedAtATime; i < std::min(count, (chunk + 1) * kPairedAtATime); ++i) {
      const Keypoint& k = left.keypoints[i];
      const int row = static_cast<int>(std::lround(k.y));
      if (row < 0 || row >= left.image.rows) continue;
      int best = -1, distance = kMaxDistance + 1;
      for (int j : table[row]) {
        const Keypoint& c = right.keypoints[j];
        const double disparity = k.x - c.x;
        const double slack = ScaleOfLevel(k.level);  // one pixel of the level
        if (std::abs(c.level - k.level) > 1 || disparity < -slack || disparity > max_disparity) {
          continue;
        }
        const int d = HammingDistance(left.descriptors[i], right.descriptors[j]);
        if (d < distance) {
          distance = d;
          best = j;
        }
      }
      if (best >= 0) found[i] = Refine(left, k, right, right.keypoints[best].raw_x);
    }
  });

  std::vector<int> differences;
  for (const Disparity& d : found) {
    if (d.difference >= 0) differences.push_back(d.difference);
  }
  double limit = 0;
  if (!differences.empty()) limit = kOutlier * UpperMedian(differences);
  for (int i = 0; i < count; ++i) {
    Keypoint& k = left.keypoints[i];
    const Disparity& d = found[i];
    const bool good = d.difference >= 0 && d.difference <= limit && d.pixels >= kMinDisparity &&
                      d.pixels <= max_disparity;
    k.depth = good ? static_cast<float>(bf / d.pixels) : Keypoint::kNoDepth;
    k.right_x = good ? static_cast<float>(k.x - d.pixels) : Keypoint::kNoDepth;
  }
}

}  // namespace alidade
