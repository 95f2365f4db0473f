#include "alidade/detect/suppress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/expect_error.h"

namespace alidade::suppress_test {
namespace {

TEST(Overlap, IsTheSharedPartOfBoth) {
  EXPECT_FLOAT_EQ(Overlap({0, 0, 10, 10}, {0, 0, 10, 10}), 1);
  EXPECT_FLOAT_EQ(Overlap({0, 0, 10, 10}, {5, 0, 10, 10}), 50.0f / 150);
  EXPECT_FLOAT_EQ(Overlap({0, 0, 10, 10}, {2, 2, 5, 4}), 0.2f);
  EXPECT_EQ(Overlap({0, 0, 10, 10}, {10, 0, 10, 10}), 0);
  EXPECT_EQ(Overlap({3, 3, 0, 0}, {3, 3, 0, 0}), 0);
}

TEST(SuppressOverlaps, KeepsTheBestOfEachClass) {
  const cv::Rect2f here(0, 0, 10, 10), near(1, 0, 10, 10), far(50, 0, 10, 10);
  const std::vector<Detection> kept =
      SuppressOverlaps({{0, 0.5f, here}, {0, 0.9f, near}, {1, 0.6f, here}, {0, 0.3f, far}}, 0.45f);
  ASSERT_EQ(kept.size(), 3u);
  EXPECT_EQ(kept[0].score, 0.9f);
  EXPECT_EQ(kept[1].score, 0.6f);  // of another class
  EXPECT_EQ(kept[2].score, 0.3f);  // elsewhere
}

// a covers b and b covers c, but a does not cover c: c remains, because b is removed.
TEST(SuppressOverlaps, LeavesOutOnlyWhatAKeptOneCovers) {
  const std::vector<Detection> kept = SuppressOverlaps(
      {{0, 0.9f, {0, 0, 10, 10}}, {0, 0.8f, {3, 0, 10, 10}}, {0, 0.7f, {6, 0, 10, 10}}}, 0.45f);
  ASSERT_EQ(kept.size(), 2u);
  EXPECT_EQ(kept[1].score, 0.7f);
}

// As many boxes as the test wants, side by side, the best last.
std::vector<Detection> SideBySide(int count) {
  std::vector<Detection> all;
  for (int i = 0; i < count; ++i)
    all.push_back(
        {0, static_cast<float>(i) / static_cast<float>(count), {static_cast<float>(i), 0, 1, 1}});
  return all;
}

TEST(SuppressOverlaps, EndsWhenThereAreMoreThanAreUsed) {
  const std::vector<Detection> kept = SuppressOverlaps(SideBySide(100000), 0.45f);
  ASSERT_EQ(kept.size(), kMostDetections + 1u);
  EXPECT_EQ(kept[0].box.x, 99999);
}

TEST(KeepBest, KeepsThoseWithTheHighestScoresAndWarnsOnce) {
  const WarningCatcher warnings;
  bool told = false;
  std::vector<Detection> few = SideBySide(kMostDetections);
  KeepBest(few, told);
  ASSERT_EQ(few.size(), static_cast<size_t>(kMostDetections));
  EXPECT_EQ(few[0].box.x, 0);  // unchanged
  EXPECT_EQ(warnings.text(), "");
  for (int i = 0; i < 2; ++i) {
    std::vector<Detection> many = SideBySide(1000);
    many[5].score = NAN;
    KeepBest(many, told);
    ASSERT_EQ(many.size(), static_cast<size_t>(kMostDetections));
    EXPECT_EQ(many.front().box.x, 999);
    EXPECT_EQ(many.back().box.x, 1000 - kMostDetections);
  }
  EXPECT_THAT(warnings.text(), testing::HasSubstr("1000 objects"));
  EXPECT_EQ(std::count(warnings.text().begin(), warnings.text().end(), '\n'), 1);
}

}  // namespace
}  // namespace alidade::suppress_test
