#include "alidade/features/corners.h"

#include <algorithm>
#include <opencv2/features2d.hpp>

namespace alidade {
namespace {

bool ByPlace(const Corner& a, const Corner& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; }

// Takes corners in the order given unless one taken before lies within `distance` pixels (to the
// precision of the grid of half that width, in the maximum norm). Stops when `limit` are taken.
std::vector<int> TakeApart(const std::vector<Corner>& corners, cv::Size level, int distance,
                           int limit) {
  const int cell = std::max(1, distance / 2);
  const int columns = level.width / cell + 1, rows = level.height / cell + 1;
  const int reach = distance / cell;
  std::vector<uint8_t> covered(static_cast<size_t>(columns) * rows, 0);
  std::vector<int> taken;
  for (int i = 0; i < static_cast<int>(corners.size()); ++i) {
    const int c = corners[i].x / cell, r = corners[i].y / cell;
    if (covered[r * columns + c]) continue;
    taken.push_back(i);
    if (static_cast<int>(taken.size()) == limit) break;
    const int c0 = std::max(0, c - reach), c1 = std::min(columns - 1, c + reach);
    for (int y = std::max(0, r - reach); y <= std::min(rows - 1, r + reach); ++y) {
      std::fill_n(covered.begin() + y * columns + c0, c1 - c0 + 1, uint8_t{1});
    }
  }
  return taken;
}

}  // namespace

std::vector<Corner> FastCorners(const cv::Mat& level, int threshold, int border, int first_row,
                                int end_row) {
  first_row = std::max(first_row, border);
  end_row = std::min(end_row, level.rows - border);
  std::vector<Corner> corners;
  if (first_row >= end_row || level.cols <= 2 * border) return corners;
  // The circle needs 3 more pixels around, suppression the scores of one row more.
  constexpr int kAround = 4;
  const cv::Rect area(border - kAround, first_row - kAround, level.cols - 2 * (border - kAround),
                      end_row - first_row + 2 * kAround);
  std::vector<cv::KeyPoint> found;
  cv::FAST(level(area), found, threshold, true);
  corners.reserve(found.size());
  for (const cv::KeyPoint& k : found) {
    const int x = static_cast<int>(k.pt.x) + area.x, y = static_cast<int>(k.pt.y) + area.y;
    if (y < first_row || y >= end_row || x < border || x >= level.cols - border) continue;
    corners.push_back({x, y, static_cast<int>(k.response)});
  }
  return corners;
}

std::vector<Corner> StrongPerCell(const std::vector<Corner>& corners, cv::Size level, int border,
                                  int cell, int strong) {
  const int columns = (level.width - 2 * border) / cell + 1;
  const int rows = (level.height - 2 * border) / cell + 1;
  std::vector<uint8_t> has_strong(static_cast<size_t>(std::max(0, columns * rows)), 0);
  const auto cell_of = [&](const Corner& c) {
    return (c.y - border) / cell * columns + (c.x - border) / cell;
  };
  for (const Corner& c : corners) {
    if (c.score >= strong) has_strong[cell_of(c)] = 1;
  }
  std::vector<Corner> kept;
  kept.reserve(corners.size());
  for (const Corner& c : corners) {
    if (c.score >= strong || !has_strong[cell_of(c)]) kept.push_back(c);
  }
  return kept;
}

std::vector<Corner> SpreadCorners(const std::vector<Corner>& corners, cv::Size level, int count) {
  if (static_cast<int>(corners.size()) <= count) return corners;
  if (count <= 0) return {};
  std::vector<Corner> by_score = corners;
  std::sort(by_score.begin(), by_score.end(), [](const Corner& a, const Corner& b) {
    return a.score != b.score ? a.score > b.score : ByPlace(a, b);
  });
  // Widest distance that leaves `count`: at 0 all are left; one corner per square is the most a
  // distance allows.
  int enough = 0, too_wide = std::max(level.width, level.height);
  std::vector<int> best;
  while (too_wide - enough > 1) {
    const int middle = enough + (too_wide - enough) / 2;
    std::vector<int> taken = TakeApart(by_score, level, middle, count);
    if (static_cast<int>(taken.size()) == count) {
      enough = middle;
      best = std::move(taken);
    } else {
      too_wide = middle;
    }
  }
  std::vector<Corner> kept;
  kept.reserve(count);
  if (best.empty()) {
    kept.assign(by_score.begin(), by_score.begin() + count);
  } else {
    for (int i : best) kept.push_back(by_score[i]);
  }
  std::sort(kept.begin(), kept.end(), ByPlace);
  return kept;
}

}  // namespace alidade
