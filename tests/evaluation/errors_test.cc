// Trajectory errors with closed-form results.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "alidade/base/error.h"
#include "alidade/base/random.h"
#include "alidade/evaluation/ate.h"
#include "alidade/evaluation/rpe.h"

namespace alidade::errors_test {
namespace {

using testing::HasSubstr;
using testing::Property;
using testing::Throws;

// A camera on a helix, 30 poses per second.
Trajectory Helix(int poses) {
  Trajectory trajectory;
  for (int i = 0; i < poses; ++i) {
    const double angle = 0.05 * i;
    trajectory.push_back(
        {i / 30.0,
         {ExpSo3({0.2 * angle, angle, 0}), {2 * std::cos(angle), 0.1 * angle, 2 * std::sin(angle)}},
         ""});
  }
  return trajectory;
}

Trajectory Moved(Trajectory trajectory, double scale, const Se3& T) {
  for (StampedPose& pose : trajectory) {
    pose.T_world_camera.t *= scale;
    pose.T_world_camera = T * pose.T_world_camera;
  }
  return trajectory;
}

const Se3 kElsewhere = {ExpSo3({0.3, -1.2, 0.7}), {5, -3, 1}};

TEST(Ate, IsZeroForTheSameTrajectoryInAnotherWorld) {
  const Trajectory truth = Helix(100);
  const AteResult result = EvaluateAte(truth, Moved(truth, 1, kElsewhere));
  EXPECT_EQ(result.error.n, 100);
  EXPECT_LT(result.error.max, 1e-12);
  EXPECT_EQ(result.coverage, 1);
}

TEST(Ate, FindsTheScaleOnlyWhenAsked) {
  const Trajectory truth = Helix(100);
  const Trajectory estimate = Moved(truth, 0.5, kElsewhere);
  const AteResult sim3 = EvaluateAte(truth, estimate, {.align = Alignment::kSim3});
  EXPECT_NEAR(sim3.T_truth_estimate.s, 2, 1e-12);
  EXPECT_LT(sim3.error.max, 1e-12);
  EXPECT_GT(EvaluateAte(truth, estimate).error.rmse, 0.5);
}

TEST(Ate, WithoutAlignmentIsThePlainDistance) {
  const Trajectory truth = Helix(50);
  const Trajectory estimate = Moved(truth, 1, {Eigen::Matrix3d::Identity(), {0.3, 0, -0.4}});
  const AteResult result = EvaluateAte(truth, estimate, {.align = Alignment::kNone});
  EXPECT_NEAR(result.error.rmse, 0.5, 1e-12);
  EXPECT_NEAR(result.error.std, 0, 1e-9);
  EXPECT_NEAR(result.error.min, 0.5, 1e-12);
}

TEST(Ate, OfNoisyPositionsIsTheNoise) {
  const Trajectory truth = Helix(3000);
  Trajectory estimate = Moved(truth, 1, kElsewhere);
  Random random(3);
  for (StampedPose& pose : estimate) {
    pose.T_world_camera.t +=
        0.01 * Eigen::Vector3d(random.Gaussian(), random.Gaussian(), random.Gaussian());
  }
  // RMSE of 3 × 3000 samples with sigma = 1 cm has the relative error 1 / sqrt(2 × 9000) = 0.75 %;
  // bound of 4 sigma.
  EXPECT_NEAR(EvaluateAte(truth, estimate).error.rmse, 0.01 * std::sqrt(3.0), 0.03 * 0.0173);
}

TEST(Ate, DoesNotDependOnTheOrderOfTheLines) {
  const Trajectory truth = Helix(100);
  Trajectory estimate = Moved(truth, 1, kElsewhere);
  estimate[40].T_world_camera.t.x() += 1;
  const double sorted = EvaluateAte(truth, estimate).error.rmse;
  std::reverse(estimate.begin(), estimate.end());
  EXPECT_NEAR(EvaluateAte(truth, estimate).error.rmse, sorted, 1e-12);
}

TEST(Ate, CoverageIsTheShareOfTrueFramesThatHaveAPose) {
  const Trajectory truth = Helix(100);
  const Trajectory half(truth.begin(), truth.begin() + 50);
  const TimeSpan all = {truth.front().time, truth.back().time};
  EXPECT_EQ(EvaluateAte(truth, half, {.source_span = all}).coverage, 0.5);
  EXPECT_EQ(EvaluateAte(truth, half).coverage, 1);
  EXPECT_EQ(EvaluateRpe(truth, half, {.source_span = all}).coverage, 0.5);
}

TEST(Statistics, AreThoseOfTheTextbook) {
  const ErrorStatistics s = DescribeErrors({4, 1, 3, 2});
  EXPECT_EQ(s.n, 4);
  EXPECT_DOUBLE_EQ(s.mean, 2.5);
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.std, std::sqrt(1.25));
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(7.5));
  EXPECT_EQ(s.min, 1);
  EXPECT_EQ(s.max, 4);
  EXPECT_EQ(DescribeErrors({5, 1, 3}).median, 3);
  EXPECT_EQ(DescribeErrors({}).n, 0);
}

// Adds the drift `step` (in the camera's frame) with each pose.
Trajectory Drifting(const Trajectory& truth, const Se3& step) {
  Trajectory estimate = {truth.front()};
  for (size_t i = 1; i < truth.size(); ++i) {
    const Se3 moved = truth[i - 1].T_world_camera.Inverse() * truth[i].T_world_camera;
    estimate.push_back({truth[i].time, estimate.back().T_world_camera * moved * step, ""});
  }
  return estimate;
}

TEST(Rpe, OverOneFrameIsTheDriftOfOneFrame) {
  const Trajectory truth = Helix(60);
  const Se3 step = {ExpSo3({0, 0.002, 0}), {0.003, 0, 0.004}};
  const RpeResult result =
      EvaluateRpe(truth, Drifting(truth, step), {.delta = 1, .unit = DeltaUnit::kFrames});
  EXPECT_EQ(result.trans.n, 58);  // 59 steps, without the one that ends at the last pose
  EXPECT_NEAR(result.trans.min, 0.005, 1e-9);
  EXPECT_NEAR(result.trans.max, 0.005, 1e-9);
  EXPECT_NEAR(result.rot.rmse, 0.002 * 180 / std::numbers::pi, 1e-9);
}

TEST(Rpe, ConsecutivePairsDoNotOverlap) {
  const Trajectory truth = Helix(91);
  const Trajectory estimate = Moved(truth, 1, kElsewhere);
  const RpeSettings seconds = {.delta = 1, .pairs = PairSelection::kConsecutive};
  EXPECT_EQ(EvaluateRpe(truth, estimate, seconds).trans.n, 3);
  const RpeSettings frames = {
      .delta = 30, .unit = DeltaUnit::kFrames, .pairs = PairSelection::kConsecutive};
  const RpeResult result = EvaluateRpe(truth, estimate, frames);
  EXPECT_EQ(result.trans.n, 3);
  EXPECT_LT(result.trans.max, 1e-12);
}

TEST(Rpe, OfEveryTwoPosesGrowsWithTheTimeBetween) {
  constexpr int kPoses = 40;
  constexpr double kDrift = 0.01;  // meters per pose, along x
  Trajectory truth, estimate;
  for (int i = 0; i < kPoses; ++i) {
    truth.push_back({i / 30.0, {Eigen::Matrix3d::Identity(), {0, 0.1 * i, 0}}, ""});
    estimate.push_back(truth.back());
    estimate.back().T_world_camera.t.x() += kDrift * i;
  }
  const RpeResult result = EvaluateRpe(truth, estimate, {.pairs = PairSelection::kEvery});
  EXPECT_EQ(result.trans.n, kPoses * kPoses);
  // Two numbers drawn uniformly from n have a mean squared difference of (n² - 1) / 6.
  EXPECT_NEAR(result.trans.rmse, kDrift * std::sqrt((kPoses * kPoses - 1) / 6.0), 1e-12);
  EXPECT_NEAR(result.trans.max, kDrift * (kPoses - 1), 1e-12);
  EXPECT_EQ(result.trans.min, 0);
  EXPECT_NEAR(result.rot.max, 0, 1e-12);
}

TEST(Rpe, AppliesTheScaleWhenAsked) {
  const Trajectory truth = Helix(90);
  const Trajectory estimate = Moved(truth, 0.25, kElsewhere);
  const RpeResult result = EvaluateRpe(truth, estimate, {.align = Alignment::kSim3});
  EXPECT_NEAR(result.scale, 4, 1e-9);
  EXPECT_LT(result.trans.max, 1e-9);
  EXPECT_GT(EvaluateRpe(truth, estimate).trans.rmse, 0.1);
}

template <typename F>
void ExpectError(F&& call, ErrorKind kind, const std::string& words) {
  EXPECT_THAT(call, Throws<Error>(testing::AllOf(Property(&Error::kind, kind),
                                                 Property(&Error::what, HasSubstr(words)))));
}

TEST(DegenerateInput, FewerThanThreePairsIsAnError) {
  const Trajectory truth = Helix(2);
  ExpectError([&] { EvaluateAte(truth, truth); }, ErrorKind::kInput, "3 are needed");
  ExpectError([&] { EvaluateRpe(truth, truth); }, ErrorKind::kInput, "3 are needed");
}

TEST(DegenerateInput, TimesThatNeverMeetAreAnErrorThatShowsBothSpans) {
  const Trajectory truth = Helix(30);
  Trajectory estimate = truth;
  for (StampedPose& pose : estimate) pose.time += 1000;
  ExpectError([&] { EvaluateAte(truth, estimate); }, ErrorKind::kInput, "1000.000000 to");
}

TEST(DegenerateInput, AllInOnePointIsAnError) {
  const Trajectory truth = Helix(30);
  Trajectory estimate = truth;
  for (StampedPose& pose : estimate) pose.T_world_camera.t.setOnes();
  ExpectError([&] { EvaluateAte(truth, estimate); }, ErrorKind::kInput, "same point");
}

TEST(DegenerateInput, NumbersThatAreNotFiniteAreAnError) {
  const Trajectory truth = Helix(30);
  Trajectory estimate = truth;
  estimate[6].T_world_camera.t.y() = std::numeric_limits<double>::quiet_NaN();
  ExpectError([&] { EvaluateAte(truth, estimate); }, ErrorKind::kInput, "pose 7 of the estimate");
  ExpectError([&] { EvaluateRpe(estimate, truth); }, ErrorKind::kInput, "pose 7 of the truth");
}

TEST(DegenerateInput, AnEmptyTrajectoryIsAnError) {
  ExpectError([] { EvaluateAte(Helix(9), {}); }, ErrorKind::kInput, "estimate has no poses");
}

TEST(DegenerateInput, ATooLongDeltaIsAnError) {
  const Trajectory truth = Helix(30);
  ExpectError([&] { EvaluateRpe(truth, truth, {.delta = 60}); }, ErrorKind::kInput,
              "smaller --delta");
}

TEST(DegenerateInput, SettingsThatCannotBeAreUsageErrors) {
  const Trajectory truth = Helix(30);
  ExpectError([&] { EvaluateAte(truth, truth, {.max_dt = -1}); }, ErrorKind::kUsage, "max-dt");
  ExpectError([&] { EvaluateRpe(truth, truth, {.delta = 0}); }, ErrorKind::kUsage, "delta");
  ExpectError([&] { EvaluateRpe(truth, truth, {.delta = 1.5, .unit = DeltaUnit::kFrames}); },
              ErrorKind::kUsage, "whole number");
}

}  // namespace
}  // namespace alidade::errors_test
