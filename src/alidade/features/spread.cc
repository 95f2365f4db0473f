#include "alidade/features/spread.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace alidade {
namespace {

constexpr int kScores = 256;

// Sorts by descending score, stable: a counting sort.
std::vector<Corner> ByScore(const std::vector<Corner>& corners) {
  std::array<int, kScores + 1> first{};
  for (const Corner& c : corners) ++first[kScores - c.score];
  for (int s = 1; s <= kScores; ++s) first[s] += first[s - 1];
  std::vector<Corner> sorted(corners.size());
  for (const Corner& c : corners) sorted[first[kScores - 1 - c.score]++] = c;
  return sorted;
}

// Greedy selection: accepts a corner unless an accepted one lies within `distance` pixels (maximum
// norm, at the resolution of a grid of half that width).
class Apart {
 public:
  void Begin(cv::Size level, int distance) {
    cell_ = std::max(1, distance / 2);
    reach_ = distance / cell_;
    // A margin of `reach_` cells on all sides avoids bounds checks.
    columns_ = level.width / cell_ + 1 + 2 * reach_;
    const int rows = level.height / cell_ + 1 + 2 * reach_;
    covered_.assign(static_cast<size_t>(columns_) * rows, 0);
  }
  bool Take(const Corner& corner) {
    const int c = corner.x / cell_, r = corner.y / cell_;
    if (covered_[(r + reach_) * columns_ + c + reach_]) return false;
    for (int y = r; y <= r + 2 * reach_; ++y) {
      std::fill_n(covered_.begin() + y * columns_ + c, 2 * reach_ + 1, uint8_t{1});
    }
    return true;
  }

 private:
  int cell_ = 1, reach_ = 0, columns_ = 0;
  std::vector<uint8_t> covered_;
};

// Flags of the first `count` of `corners` at the largest distance that still yields that number,
// and that distance.
struct EvenChoice {
  std::vector<uint8_t> taken;
  int distance = 0;
};

EvenChoice ChooseEvenly(const std::vector<Corner>& corners, cv::Size level, int count) {
  EvenChoice best{std::vector<uint8_t>(corners.size(), 0), 0};
  std::fill_n(best.taken.begin(), count, uint8_t{1});
  Apart apart;
  // Upper bound: `count` corners at this distance would need more area than the level has, since
  // each occupies a square of at least half the distance.
  int too_wide = 2 + static_cast<int>(2 * std::sqrt(static_cast<double>(level.area()) / count));
  while (too_wide - best.distance > 1) {
    EvenChoice choice{std::vector<uint8_t>(corners.size(), 0), (best.distance + too_wide) / 2};
    apart.Begin(level, choice.distance);
    int taken = 0;
    for (size_t i = 0; i < corners.size() && taken < count; ++i) {
      choice.taken[i] = apart.Take(corners[i]);
      taken += choice.taken[i];
    }
    if (taken == count)
      best = std::move(choice);
    else
      too_wide = choice.distance;
  }
  return best;
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
  const int even = std::clamp(static_cast<int>(std::lround(evenness * count)), 1, count);
  EvenChoice choice = ChooseEvenly(by_score, level, even);

  // The remaining corners by strength, at a fraction of the distance that all `count` would have if
  // distributed evenly.
  constexpr double kClose = 0.4;
  Apart apart;
  apart.Begin(level, static_cast<int>(kClose * choice.distance * std::sqrt(evenness)));
  std::vector<Corner> kept;
  kept.reserve(count);
  for (size_t i = 0; i < by_score.size(); ++i) {
    if (!choice.taken[i]) continue;
    apart.Take(by_score[i]);
    kept.push_back(by_score[i]);
  }
  for (size_t i = 0; i < by_score.size() && static_cast<int>(kept.size()) < count; ++i) {
    if (choice.taken[i] || !apart.Take(by_score[i])) continue;
    choice.taken[i] = 1;
    kept.push_back(by_score[i]);
  }
  for (size_t i = 0; i < by_score.size() && static_cast<int>(kept.size()) < count; ++i) {
    if (!choice.taken[i]) kept.push_back(by_score[i]);
  }
  std::sort(kept.begin(), kept.end(),
            [](const Corner& a, const Corner& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; });
  return kept;
}

}  // namespace alidade
