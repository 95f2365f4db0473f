#include "alidade/features/spread.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "alidade/base/random.h"

namespace alidade::spread_test {
namespace {

// Strong corners are concentrated at the left; all others are weak.
std::vector<Corner> Crowd(cv::Size level) {
  Random random(2);
  std::set<std::pair<int, int>> places;
  std::vector<Corner> corners;
  for (int i = 0; i < 4000; ++i) {
    const bool left = i % 2 == 0;
    const int x = static_cast<int>(random.Uniform(20, left ? 120 : level.width - 20));
    const int y = static_cast<int>(random.Uniform(20, level.height - 20));
    if (!places.insert({y, x}).second) continue;
    corners.push_back(
        {x, y, static_cast<int>(left && x < 120 ? random.Uniform(40, 90) : random.Uniform(8, 30))});
  }
  std::sort(corners.begin(), corners.end(),
            [](const Corner& a, const Corner& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; });
  return corners;
}

int CellsTaken(const std::vector<Corner>& corners) {
  std::set<std::pair<int, int>> cells;
  for (const Corner& c : corners) cells.insert({c.y / 40, c.x / 40});
  return static_cast<int>(cells.size());
}

TEST(SpreadCorners, CoversMoreOfTheImageTheEvenerItIsAsked) {
  const cv::Size level(640, 480);
  const std::vector<Corner> corners = Crowd(level);
  const int strongest = CellsTaken(SpreadCorners(corners, level, 200, 0));
  const int half = CellsTaken(SpreadCorners(corners, level, 200, 0.5));
  const int even = CellsTaken(SpreadCorners(corners, level, 200, 1));
  EXPECT_LT(2 * strongest, half);
  EXPECT_LE(half, even);
  EXPECT_GT(even, 0.8 * 160);  // 160 cells of 40 pixels have corners
}

TEST(SpreadCorners, KeepsTheStrongestWhenAskedForNoEvenness) {
  const std::vector<Corner> corners = Crowd({640, 480});
  std::vector<int> scores, kept;
  for (const Corner& c : corners) scores.push_back(c.score);
  std::sort(scores.rbegin(), scores.rend());
  for (const Corner& c : SpreadCorners(corners, {640, 480}, 300, 0)) kept.push_back(c.score);
  std::sort(kept.rbegin(), kept.rend());
  scores.resize(300);
  EXPECT_EQ(kept, scores);
}

TEST(SpreadCorners, GivesAsManyAsAskedForInReadingOrder) {
  const std::vector<Corner> corners = Crowd({640, 480});
  for (int count : {0, 1, 2, 17, 500, static_cast<int>(corners.size()) - 1}) {
    const std::vector<Corner> kept = SpreadCorners(corners, {640, 480}, count, 0.5);
    EXPECT_EQ(static_cast<int>(kept.size()), count);
    for (size_t i = 1; i < kept.size(); ++i) {
      EXPECT_TRUE(kept[i - 1].y < kept[i].y ||
                  (kept[i - 1].y == kept[i].y && kept[i - 1].x < kept[i].x));
    }
  }
  EXPECT_EQ(SpreadCorners(corners, {640, 480}, 100000, 0.5).size(), corners.size());
}

TEST(SpreadCorners, LeavesADistanceBetweenThoseItKeeps) {
  const std::vector<Corner> kept = SpreadCorners(Crowd({640, 480}), {640, 480}, 150, 1);
  int closest = 1000;
  for (size_t i = 0; i < kept.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      closest = std::min(
          closest, std::max(std::abs(kept[i].x - kept[j].x), std::abs(kept[i].y - kept[j].y)));
    }
  }
  // A square lattice of 150 points in 600 x 440 has a spacing of 42 pixels; a greedy selection from
  // random positions reaches about half.
  EXPECT_GT(closest, 15);
}

TEST(StrongPerCell, KeepsWeakCornersOnlyWhereThereIsNothingBetter) {
  const std::vector<Corner> corners = {
      {20, 20, 50}, {25, 20, 10}, {60, 20, 9}, {61, 25, 8}, {20, 60, 20}};
  const std::vector<Corner> kept = StrongPerCell(corners, {200, 200}, 19, 32, 20);
  std::vector<int> scores;
  for (const Corner& c : kept) scores.push_back(c.score);
  EXPECT_EQ(scores, (std::vector<int>{50, 9, 8, 20}));
}

}  // namespace
}  // namespace alidade::spread_test
