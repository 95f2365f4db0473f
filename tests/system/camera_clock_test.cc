#include "alidade/system/camera/camera_clock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace alidade::camera_clock_test {
namespace {

using testing::ElementsAre;
constexpr ClockStep kGoesOn = ClockStep::kGoesOn, kLate = ClockStep::kLate, kGap = ClockStep::kGap,
                    kBack = ClockStep::kBack;

// A clock after ten frames, `interval` seconds apart, the last at 100 s.
CameraClock Started(double interval) {
  CameraClock clock;
  for (int i = 9; i >= 0; --i) EXPECT_EQ(clock.Take(100 - i * interval), kGoesOn);
  return clock;
}

std::vector<ClockStep> Steps(CameraClock& clock, const std::vector<double>& times) {
  std::vector<ClockStep> steps;
  double steady = -1;
  for (const double time : times) {
    steps.push_back(clock.Take(time));
    if (steps.back() == kLate) continue;
    EXPECT_GT(clock.steady(), steady) << time;
    steady = clock.steady();
  }
  return steps;
}

TEST(CameraClock, DroppedFramesAreNoGap) {
  CameraClock clock = Started(0.033);
  EXPECT_THAT(Steps(clock, {100.1, 100.2, 101, 101.033}),
              ElementsAre(kGoesOn, kGoesOn, kGoesOn, kGoesOn));
  EXPECT_EQ(clock.steady(), 101.033);
}

TEST(CameraClock, ALongPauseIsAGap) {
  CameraClock clock = Started(0.033);
  EXPECT_THAT(Steps(clock, {103, 103.033, 3703}), ElementsAre(kGap, kGoesOn, kGap));
  EXPECT_NEAR(clock.jump(), 3599.967, 1e-9);
}

TEST(CameraClock, PicturesTakenFarApartHaveNoGaps) {
  CameraClock clock = Started(2);
  EXPECT_THAT(Steps(clock, {102, 110, 112, 140}), ElementsAre(kGoesOn, kGoesOn, kGoesOn, kGap));
}

TEST(CameraClock, NothingIsUsualAtTheBeginning) {
  CameraClock clock;
  EXPECT_THAT(Steps(clock, {0, 5, 5.033, 5.066}), ElementsAre(kGoesOn, kGoesOn, kGoesOn, kGoesOn));
}

TEST(CameraClock, DoublesAndLateFramesAreNotTaken) {
  CameraClock clock = Started(0.1);
  EXPECT_THAT(Steps(clock, {100, 100, 100, 100, 100.1, 99.9, 100.2, 100.15, 100.3}),
              ElementsAre(kLate, kLate, kLate, kLate, kGoesOn, kLate, kGoesOn, kLate, kGoesOn));
}

TEST(CameraClock, AClockThatWasSetBackIsBelievedAfterThreeFrames) {
  CameraClock clock = Started(0.1);
  EXPECT_THAT(Steps(clock, {40, 40.1, 40.2, 40.3}), ElementsAre(kLate, kLate, kBack, kGoesOn));
}

TEST(CameraClock, OneStampAnHourAheadCostsTwoFrames) {
  CameraClock clock = Started(0.1);
  EXPECT_THAT(Steps(clock, {3700, 100.2, 100.3, 100.4, 100.5}),
              ElementsAre(kGap, kLate, kLate, kBack, kGoesOn));
}

TEST(CameraClock, AfterARestartAnyTimeWillDo) {
  CameraClock clock = Started(0.1);
  clock.Restart();
  EXPECT_THAT(Steps(clock, {3, 3.1}), ElementsAre(kGoesOn, kGoesOn));
  clock.Restart();
  EXPECT_THAT(Steps(clock, {9000, 9000.1}), ElementsAre(kGoesOn, kGoesOn));
}

}  // namespace
}  // namespace alidade::camera_clock_test
