#include "alidade/features/spread.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace alidade {
namespace {

constexpr int kScores = 256;

// Strongest first, equal ones as they stood: a counting sort.
std::vector<Corner> ByScore(const std::vector<Corner>& corners) {
  std::array<int, kScores + 1> first{};
  for (const Corner& c : corners) ++first[kScores - c.score];
  for (int s = 1; s <= kScores; ++s) first[s] += first[s - 1];
  std::vector<Corner> sorted(corners.size());
  for (const Corner& c : corners) sorted[first[kScores - 1 - c.score]++] = c;
  return sorted;
}

// Takes corners in the order given unless one taken before lies within `distance` pixels (in the
// maximum norm, to the precision of a grid of half that width). Stops when `limit` are taken.
void TakeApart(const std::vector<Corner>& corners, cv::Size level, int distance, int limit,
               std::vector<uint8_t>& covered, std::vector<int>& taken) {
  const int cell = std::max(1, distance / 2);
  const int reach = distance / cell;
  // A rim of `reach` cells all around saves asking where the image ends.
  const int columns = level.width / cell + 1 + 2 * reach,
            rows = level.height / cell + 1 + 2 * reach;
  covered.assign(static_cast<size_t>(columns) * rows, 0);
  taken.clear();
  for (int i = 0; i < static_cast<int>(corners.size()); ++i) {
    const int c = corners[i].x / cell, r = corners[i].y / cell;
    if (covered[(r + reach) * columns + c + reach]) continue;
    taken.push_back(i);
    if (static_cast<int>(taken.size()) == limit) break;
    for (int y = r; y <= r + 2 * reach; ++y) {
      std::fill_n(covered.begin() + y * columns + c, 2 * reach + 1, uint8_t{1});
    }
  }
}

}  // namespace

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

std::vector<Corner> SpreadCorners(const std::vector<Corner>& corners, cv::Size level, int count,
                                  double evenness) {
  if (static_cast<int>(corners.size()) <= count) return corners;
  if (count <= 0) return {};
  const std::vector<Corner> by_score = ByScore(corners);
  std::vector<uint8_t> covered;
  std::vector<int> taken;
  const auto leaves_enough = [&](int distance) {
    TakeApart(by_score, level, distance, count, covered, taken);
    return static_cast<int>(taken.size()) == count;
  };
  // `enough` leaves `count`, `too_wide` does not: even filled without a gap, squares of half the
  // distance (at least) per corner would need more than the level.
  int enough = 0;
  int too_wide = 2 + static_cast<int>(2 * std::sqrt(static_cast<double>(level.area()) / count));
  while (too_wide - enough > 1) {
    const int middle = (enough + too_wide) / 2;
    (leaves_enough(middle) ? enough : too_wide) = middle;
  }
  const int distance = static_cast<int>(std::lround(evenness * enough));
  std::vector<Corner> kept(by_score.begin(), by_score.begin() + count);
  if (distance > 0 && leaves_enough(distance)) {
    for (int i = 0; i < count; ++i) kept[i] = by_score[taken[i]];
  }
  std::sort(kept.begin(), kept.end(),
            [](const Corner& a, const Corner& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; });
  return kept;
}

}  // namespace alidade
