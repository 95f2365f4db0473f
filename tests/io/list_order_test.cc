#include "alidade/io/files/datasets/list_order.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "alidade/io/files/datasets/recording.h"
#include "support/expect_error.h"

namespace alidade::list_order_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<StampedName> ListOf(const std::vector<double>& times) {
  std::vector<StampedName> list;
  for (const double time : times)
    list.push_back({time, std::to_string(time), std::to_string(list.size()) + ".png", ""});
  return list;
}

// `count` times at 10 Hz from `begin` on.
std::vector<double> Steady(double begin, int count) {
  std::vector<double> times;
  for (int i = 0; i < count; ++i) times.push_back(begin + 0.1 * i);
  return times;
}

std::vector<double> Joined(std::vector<double> a, const std::vector<double>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(ListOrder, ASecondRecordingInTheListIsAnotherPart) {
  const auto list = ListOf(Joined(Steady(100, 30), Steady(0, 30)));
  const ListOrder order = OrderOf(list);
  EXPECT_EQ(order.parts(), 2);
  EXPECT_FALSE(order.sorted);
  EXPECT_EQ(order.part[29], 0);
  EXPECT_EQ(order.part[30], 1);
  WarningCatcher warnings;
  const auto frames = FramesOf(list, "rgb");
  EXPECT_EQ(frames[30].image, "rgb/30.png");
  EXPECT_EQ(frames[30].part, 1);
  EXPECT_EQ(frames[30].problem, "");
  EXPECT_THAT(warnings.text(), HasSubstr("go back 1 time by more than a second"));
}

TEST(ListOrder, PartsAreAssociatedEachWithItsOwn) {
  // The times of both parts are the same: only their order tells them apart.
  const auto list = ListOf(Joined(Steady(0, 30), Steady(0, 30)));
  auto frames = FramesOf(list, "rgb");
  auto depths = ListOf(Joined(Steady(0.01, 30), Steady(0.01, 30)));
  EXPECT_EQ(AttachByTime(frames, &RecordedFrame::depth, depths, "depth", 0.02), 60);
  EXPECT_EQ(frames[5].depth, "depth/5.png");
  EXPECT_EQ(frames[35].depth, "depth/35.png");
}

TEST(ListOrder, NeighborsThatWereWrittenInTheWrongOrderAreSorted) {
  auto times = Steady(0, 30);
  std::swap(times[10], times[12]);
  const ListOrder order = OrderOf(ListOf(times));
  EXPECT_EQ(order.parts(), 1);
  EXPECT_TRUE(order.sorted);
  EXPECT_EQ(order.order[10], 12u);
}

TEST(ListOrder, OneDamagedStampIsNoOtherRecording) {
  for (const double wrong : {0.0, 5000.0}) {
    auto times = Steady(100, 40);
    times[20] = wrong;
    const ListOrder order = OrderOf(ListOf(times));
    EXPECT_EQ(order.parts(), 1) << wrong;
    EXPECT_EQ(order.order[wrong > 100 ? 39u : 0u], 20u) << wrong;
  }
}

TEST(ListOrder, AListWithoutOrderIsSortedAsAWhole) {
  std::vector<double> times;
  for (int i = 0; i < 40; ++i) times.push_back(static_cast<double>(i * 17 % 40) * 2);
  const ListOrder order = OrderOf(ListOf(times));
  EXPECT_EQ(order.parts(), 1);
  for (size_t i = 0; i < times.size(); ++i)
    EXPECT_EQ(times[order.order[i]], 2.0 * static_cast<double>(i));
}

}  // namespace
}  // namespace alidade::list_order_test
