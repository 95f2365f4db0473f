#include "alidade/features/fast.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <opencv2/core/hal/intrin.hpp>
#include <utility>
#include <vector>

#include "alidade/features/simd/fast_row.h"

namespace alidade {
namespace {

constexpr int kCircle = 16;
constexpr int kLanes = 16;  // pixels processed in parallel
constexpr std::array<int, kCircle> kCircleX = {0, 1,  2,  3,  3,  3,  2,  1,
                                               0, -1, -2, -3, -3, -3, -2, -1};
constexpr std::array<int, kCircle> kCircleY = {-3, -3, -2, -1, 0, 1,  2,  3,
                                               3,  3,  2,  1,  0, -1, -2, -3};

// Of the 16 runs of nine contiguous values the one whose weakest value is the strongest: that
// value. Runs k and k + 1 share eight values: with m their weakest, the better run of the two gives
// weaker(m, stronger(first, last)). Bright: a value is the stronger the larger it is; else the
// smaller.
template <bool bright, typename Vector>
Vector BestRun(const std::array<Vector, kCircle>& d) {
  const auto weaker = [](const Vector& a, const Vector& b) {
    return bright ? cv::v_min(a, b) : cv::v_max(a, b);
  };
  const auto stronger = [](const Vector& a, const Vector& b) {
    return bright ? cv::v_max(a, b) : cv::v_min(a, b);
  };
  std::array<Vector, kCircle / 2> two, four;  // runs that begin at odd positions
#pragma GCC unroll 8
  for (int i = 0; i < kCircle / 2; ++i) two[i] = weaker(d[2 * i + 1], d[(2 * i + 2) % kCircle]);
#pragma GCC unroll 8
  for (int i = 0; i < kCircle / 2; ++i) four[i] = weaker(two[i], two[(i + 1) % 8]);
  Vector best;
#pragma GCC unroll 8
  for (int i = 0; i < kCircle / 2; ++i) {
    const Vector eight = weaker(four[i], four[(i + 2) % 8]);
    const Vector nine = weaker(eight, stronger(d[2 * i], d[(2 * i + 9) % kCircle]));
    best = i == 0 ? nine : stronger(best, nine);
  }
  return best;
}

// Scores plus one of 16 pixels, 0 where the score is at most `threshold`. Returns false if all are
// 0.
bool ScoreBlock(const uint8_t* p, ptrdiff_t stride, const cv::v_uint8x16& threshold,
                cv::v_uint8x16& scores) {
  using cv::v_max;
  using cv::v_min;
  const cv::v_uint8x16 centre = cv::v_load(p);
  // Nine contiguous pixels contain the top or bottom and the left or right pixel. Subtraction
  // saturates at 0.
  const cv::v_uint8x16 top = cv::v_load(p - 3 * stride), right = cv::v_load(p + 3);
  const cv::v_uint8x16 bottom = cv::v_load(p + 3 * stride), left = cv::v_load(p - 3);
  const cv::v_uint8x16 bright = v_min(v_max(top, bottom), v_max(left, right)) - centre;
  const cv::v_uint8x16 dark = centre - v_max(v_min(top, bottom), v_min(left, right));
  const bool maybe_bright = cv::v_check_any(bright > threshold);
  const bool maybe_dark = cv::v_check_any(dark > threshold);
  if (!maybe_bright && !maybe_dark) return false;
  std::array<cv::v_uint8x16, kCircle> d;
#pragma GCC unroll 16
  for (int k = 0; k < kCircle; ++k) d[k] = cv::v_load(p + kCircleY[k] * stride + kCircleX[k]);
  cv::v_uint8x16 best = cv::v_setzero_u8();
  if (maybe_bright) best = BestRun<true>(d) - centre;
  if (maybe_dark) best = v_max(best, centre - BestRun<false>(d));
  const cv::v_uint8x16 corner = best > threshold;
  if (!cv::v_check_any(corner)) return false;
  scores = best & corner;
  return true;
}

// Scores of one image row, and the columns with nonzero scores.
struct ScoreRow {
  std::vector<uint8_t> score;  // score plus one; 0 = no corner
  std::vector<int> columns;    // the first `count` are used
  int count = 0;
};

}  // namespace

int FastRow16(const uint8_t* pixels, int first, int end, ptrdiff_t stride, uint8_t threshold,
              uint8_t* score, int* columns) {
  const cv::v_uint8x16 over = cv::v_setall_u8(threshold);
  int count = 0;
  for (int x = first; x < end; x += kLanes) {
    // The last block moves back to stay inside the row; the column test below masks pixels
    // processed twice.
    const int x0 = std::min(x, end - kLanes);
    cv::v_uint8x16 scores;
    if (!ScoreBlock(pixels + x0, stride, over, scores)) continue;
    std::array<uint8_t, kLanes> values;
    cv::v_store(values.data(), scores);
    for (int mask = cv::v_signmask(scores > cv::v_setzero_u8()), lane = 0; mask != 0;
         ++lane, mask >>= 1) {
      if (!(mask & 1) || x0 + lane < x) continue;
      score[x0 + lane] = values[lane];
      columns[count++] = x0 + lane;
    }
  }
  return count;
}

FastRow FastRowFor(int end) {
  constexpr int kReach = 3;  // of the circle
#ifdef ALIDADE_AVX2
  if (HasAvx2() && end >= 2 * kLanes + kReach) return FastRow32;
#endif
  return end >= kLanes + kReach ? FastRow16 : nullptr;
}

std::vector<Corner> FastCorners(const cv::Mat& image, int threshold, int border, int first_row,
                                int end_row) {
  std::vector<Corner> corners;
  // Suppression needs scores of one more column on each side.
  const int first = border - 1, end = image.cols - border + 1;
  // On narrow images a block may extend past the border, but not past the image.
  const FastRow score_row = FastRowFor(end);
  if (first_row >= end_row || end - first <= 2 || !score_row) return corners;
  const auto over = static_cast<uint8_t>(threshold);
  std::array<ScoreRow, 3> rows;  // above, this, below
  for (ScoreRow& row : rows) {
    row.score.assign(image.cols, 0);
    row.columns.resize(image.cols);
  }
  const auto look = [&](int y, ScoreRow& row) {
    for (int i = 0; i < row.count; ++i) row.score[row.columns[i]] = 0;
    row.count = score_row(image.ptr<uint8_t>(y), first, end, static_cast<ptrdiff_t>(image.step[0]),
                          over, row.score.data(), row.columns.data());
  };
  look(first_row - 1, rows[0]);
  look(first_row, rows[1]);
  for (int y = first_row; y < end_row; ++y) {
    look(y + 1, rows[2]);
    const uint8_t *above = rows[0].score.data(), *here = rows[1].score.data(),
                  *below = rows[2].score.data();
    for (int i = 0; i < rows[1].count; ++i) {
      const int x = rows[1].columns[i];
      if (x == first || x == end - 1) continue;
      const int s = here[x];
      const bool top = s > above[x - 1] && s > above[x] && s > above[x + 1] && s > here[x - 1] &&
                       s >= here[x + 1] && s >= below[x - 1] && s >= below[x] && s >= below[x + 1];
      if (top) corners.push_back({x, y, s - 1});
    }
    std::swap(rows[0], rows[1]);
    std::swap(rows[1], rows[2]);
  }
  return corners;
}

Eigen::Vector2d RefineCorner(const cv::Mat& image, const Corner& corner) {
  // Half a pixel plus noise: farther away the neighbor would have the higher score.
  constexpr double kFarthest = 0.6;
  const auto stride = static_cast<ptrdiff_t>(image.step[0]);
  const uint8_t* centre = image.ptr<uint8_t>(corner.y) + corner.x - 1;
  // Four pixels of each of the three rows, of which three are used.
  const auto around = [&](const uint8_t* p) {
    const auto four = [&](ptrdiff_t offset) {
      unsigned pixels;
      std::memcpy(&pixels, p + offset, sizeof pixels);
      return pixels;
    };
    return cv::v_reinterpret_as_u8(cv::v_uint32x4(four(-stride), four(0), four(stride), 0));
  };
  std::array<cv::v_uint8x16, kCircle> d;
#pragma GCC unroll 16
  for (int k = 0; k < kCircle; ++k) d[k] = around(centre + kCircleY[k] * stride + kCircleX[k]);
  // Signed scores, as bright and as dark corner.
  std::array<uint8_t, 16> middle, brightest, darkest;
  cv::v_store(middle.data(), around(centre));
  cv::v_store(brightest.data(), BestRun<true>(d));
  cv::v_store(darkest.data(), BestRun<false>(d));
  constexpr int kOwn = 5;  // the corner's own: row 1, column 1
  const bool is_bright = brightest[kOwn] + darkest[kOwn] >= 2 * middle[kOwn];
  std::array<std::array<int, 3>, 3> s;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      const int i = 4 * row + column;
      s[row][column] = is_bright ? brightest[i] - middle[i] : middle[i] - darkest[i];
    }
  }
  // Central differences, smoothed across with 1 2 1.
  const double gx = ((s[0][2] - s[0][0]) + 2 * (s[1][2] - s[1][0]) + (s[2][2] - s[2][0])) / 8.0;
  const double gy = ((s[2][0] - s[0][0]) + 2 * (s[2][1] - s[0][1]) + (s[2][2] - s[0][2])) / 8.0;
  const double xx = ((s[0][2] + s[0][0] - 2 * s[0][1]) + 2 * (s[1][2] + s[1][0] - 2 * s[1][1]) +
                     (s[2][2] + s[2][0] - 2 * s[2][1])) /
                    4.0;
  const double yy = ((s[2][0] + s[0][0] - 2 * s[1][0]) + 2 * (s[2][1] + s[0][1] - 2 * s[1][1]) +
                     (s[2][2] + s[0][2] - 2 * s[1][2])) /
                    4.0;
  const double xy = (s[2][2] + s[0][0] - s[2][0] - s[0][2]) / 4.0;
  Eigen::Vector2d place(corner.x, corner.y);
  const double det = xx * yy - xy * xy;
  if (!(xx < 0 && det > 0)) return place;
  Eigen::Vector2d shift(-(yy * gx - xy * gy) / det, -(xx * gy - xy * gx) / det);
  const double largest = shift.cwiseAbs().maxCoeff();
  if (largest > kFarthest) shift *= kFarthest / largest;
  return place + shift;
}

}  // namespace alidade
