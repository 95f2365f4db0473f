#include "alidade/detect/suppress.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace alidade::suppress_test
