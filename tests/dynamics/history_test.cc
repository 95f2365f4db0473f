// Past views, addressed by their age in frames.
#include "alidade/dynamics/history.h"

#include <gtest/gtest.h>

#include <memory>

namespace alidade::history_test {
namespace {

std::shared_ptr<const PastView> View(int number) {
  auto view = std::make_shared<PastView>();
  view->number = number;
  return view;
}

TEST(History, FindsTheFramesOfTheLastSecondByHowManyFramesAgoTheyWere) {
  History history;
  EXPECT_EQ(history.Before(1), nullptr);
  for (int number = 0; number < 100; ++number) {
    for (int ago = 1; ago <= 30 && ago <= number; ++ago) {
      ASSERT_NE(history.Before(ago), nullptr);
      ASSERT_EQ(history.Before(ago)->number, number - ago);
    }
    history.Add(View(number));
  }
  EXPECT_EQ(history.Before(0), nullptr);
  EXPECT_EQ(history.Before(-1), nullptr);
  EXPECT_EQ(history.Before(1000), nullptr);
}

TEST(History, FramesWithoutAPoseAreGapsThatCount) {
  History history;
  for (int number = 0; number < 30; ++number) history.Add(number % 3 == 0 ? nullptr : View(number));
  for (int ago = 1; ago <= 30; ++ago) {
    const PastView* view = history.Before(ago);
    if ((30 - ago) % 3 == 0) {
      EXPECT_EQ(view, nullptr);
    } else {
      ASSERT_NE(view, nullptr);
      EXPECT_EQ(view->number, 30 - ago);
    }
  }
}

TEST(History, OlderOnesAreSomeFramesApartAndBounded) {
  History history;
  for (int number = 0; number < 1000; ++number)
    history.Add(number % 7 == 3 ? nullptr : View(number));
  size_t count = 0;
  int last = history.Before(1)->number;
  while (const PastView* view = history.Older(count)) {
    EXPECT_LE(view->number, last - (count == 0 ? 30 : 5));
    EXPECT_GE(view->number, last - 60);
    last = view->number;
    ++count;
  }
  EXPECT_GE(count, 5u);
  EXPECT_LE(count, 30u);  // each holds all cells of an image
}

TEST(History, ForgetsEarlierPosesButGoesOnCountingFrames) {
  History history;
  for (int number = 0; number < 80; ++number) history.Add(View(number));
  history.Clear();
  for (int ago = 1; ago < 100; ++ago) EXPECT_EQ(history.Before(ago), nullptr);
  EXPECT_EQ(history.Older(0), nullptr);
  history.Add(View(80));
  ASSERT_NE(history.Before(1), nullptr);
  EXPECT_EQ(history.Before(1)->number, 80);
  EXPECT_EQ(history.Before(2), nullptr);
}

}  // namespace
}  // namespace alidade::history_test
