#include "alidade/features/fast.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/core/hal/intrin.hpp>
#include <utility>
#include <vector>

#include "alidade/features/fast_row.h"

namespace alidade {
namespace {

constexpr int kCircle = 16;
constexpr int kLanes = 16;  // pixels processed in parallel
constexpr std::array<int, kCircle> kCircleX = {0, 1,  2,  3,  3,  3,  2,  1,
                                               0, -1, -2, -3, -3, -3, -2, -1};
constexpr std::array<int, kCircle> kCircleY = {-3, -3, -2, -1, 0, 1,  2,  3,
                                               3,  3,  2,  1,  0, -1, -2, -3};

using Offsets = std::array<int, kCircle>;

Offsets CircleOffsets(const cv::Mat& image) {
  Offsets offsets;
  for (int k = 0; k < kCircle; ++k) {
    offsets[k] = kCircleY[k] * static_cast<int>(image.step[0]) + kCircleX[k];
  }
  return offsets;
}

// Maximum over the 16 runs of nine contiguous values of the minimum of the run. Runs k and k + 1
// share eight values: with m their minimum, the better run of the two gives min(m, max(first,
// last)).
template <typename Vector>
Vector BestRun(const std::array<Vector, kCircle>& d) {
  using cv::v_max;
  using cv::v_min;
  std::array<Vector, kCircle / 2> two, four;  // runs that begin at odd positions
  for (int i = 0; i < kCircle / 2; ++i) two[i] = v_min(d[2 * i + 1], d[(2 * i + 2) % kCircle]);
  for (int i = 0; i < kCircle / 2; ++i) four[i] = v_min(two[i], two[(i + 1) % 8]);
  Vector best;
  for (int i = 0; i < kCircle / 2; ++i) {
    const Vector eight = v_min(four[i], four[(i + 2) % 8]);
    const Vector nine = v_min(eight, v_max(d[2 * i], d[(2 * i + 9) % kCircle]));
    best = i == 0 ? nine : v_max(best, nine);
  }
  return best;
}

// Scores plus one of 16 pixels, 0 where the score is at most `threshold`. Returns false if all are
// 0.
bool ScoreBlock(const uint8_t* p, const int* circle, const cv::v_uint8x16& threshold,
                cv::v_uint8x16& scores) {
  using cv::v_max;
  using cv::v_min;
  const cv::v_uint8x16 centre = cv::v_load(p);
  std::array<cv::v_uint8x16, kCircle> d;
  // Nine contiguous pixels contain the top or bottom and the left or right pixel. Subtraction
  // saturates at 0.
  const cv::v_uint8x16 top = cv::v_load(p + circle[0]), right = cv::v_load(p + circle[4]);
  const cv::v_uint8x16 bottom = cv::v_load(p + circle[8]), left = cv::v_load(p + circle[12]);
  const cv::v_uint8x16 bright = v_min(v_max(top, bottom), v_max(left, right)) - centre;
  const cv::v_uint8x16 dark = centre - v_max(v_min(top, bottom), v_min(left, right));
  const bool maybe_bright = cv::v_check_any(bright > threshold);
  const bool maybe_dark = cv::v_check_any(dark > threshold);
  if (!maybe_bright && !maybe_dark) return false;
  cv::v_uint8x16 best = cv::v_setzero_u8();
  if (maybe_bright) {
    for (int k = 0; k < kCircle; ++k) d[k] = cv::v_load(p + circle[k]) - centre;
    best = BestRun(d);
  }
  if (maybe_dark) {
    for (int k = 0; k < kCircle; ++k) d[k] = centre - cv::v_load(p + circle[k]);
    best = v_max(best, BestRun(d));
  }
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

int FastRow16(const uint8_t* pixels, int first, int end, const int* circle, uint8_t threshold,
              uint8_t* score, int* columns) {
  const cv::v_uint8x16 over = cv::v_setall_u8(threshold);
  int count = 0;
  for (int x = first; x < end; x += kLanes) {
    // The last block moves back to stay inside the row; the column test below masks pixels
    // processed twice.
    const int x0 = std::min(x, end - kLanes);
    cv::v_uint8x16 scores;
    if (!ScoreBlock(pixels + x0, circle, over, scores)) continue;
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
#ifdef ALIDADE_FAST_ROW_32
  static const bool has_avx2 = __builtin_cpu_supports("avx2");
  if (has_avx2 && end >= 2 * kLanes + kReach) return FastRow32;
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
  const Offsets circle = CircleOffsets(image);
  const auto over = static_cast<uint8_t>(threshold);
  std::array<ScoreRow, 3> rows;  // above, this, below
  for (ScoreRow& row : rows) {
    row.score.assign(image.cols, 0);
    row.columns.resize(image.cols);
  }
  const auto look = [&](int y, ScoreRow& row) {
    for (int i = 0; i < row.count; ++i) row.score[row.columns[i]] = 0;
    row.count = score_row(image.ptr<uint8_t>(y), first, end, circle.data(), over, row.score.data(),
                          row.columns.data());
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
  const Offsets circle = CircleOffsets(image);
  // Signed scores of 3 rows of 8 pixels (3 of each are used), as bright and as dark corner.
  std::array<std::array<int16_t, 8>, 3> bright, dark;
  for (int row = 0; row < 3; ++row) {
    const uint8_t* p = image.ptr<uint8_t>(corner.y + row - 1) + corner.x - 1;
    const cv::v_int16x8 centre = cv::v_reinterpret_as_s16(cv::v_load_expand(p));
    std::array<cv::v_int16x8, kCircle> up, down;
    for (int k = 0; k < kCircle; ++k) {
      const cv::v_int16x8 rim = cv::v_reinterpret_as_s16(cv::v_load_expand(p + circle[k]));
      up[k] = rim - centre;
      down[k] = centre - rim;
    }
    cv::v_store(bright[row].data(), BestRun(up));
    cv::v_store(dark[row].data(), BestRun(down));
  }
  const auto& s = bright[1][1] >= dark[1][1] ? bright : dark;
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
