// Detection of wrong poses on synthetic trajectories.
#include "alidade/evaluation/false_poses.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "alidade/base/error.h"
#include "alidade/base/random.h"

namespace alidade::false_poses_test {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// A half circle of 2 m radius, 6.28 m long, with 200 poses that look along it.
Trajectory HalfCircle() {
  Trajectory trajectory;
  for (int i = 0; i < 200; ++i) {
    const double angle = std::numbers::pi * i / 199;
    trajectory.push_back(
        {i / 30.0, {ExpSo3({0, angle, 0}), {2 * std::sin(angle), 0, 2 * std::cos(angle)}}, ""});
  }
  return trajectory;
}

Trajectory StraightOn() {
  Trajectory trajectory;
  for (int i = 0; i < 100; ++i) trajectory.push_back({i / 10.0, {{}, {0, 0, 0.8 * i}}, ""});
  for (StampedPose& pose : trajectory) pose.T_world_camera.R.setIdentity();
  return trajectory;
}

// Transforms to another world with another scale, as in a monocular result.
Trajectory Elsewhere(Trajectory trajectory) {
  const Se3 T = {ExpSo3({0.3, -1.2, 0.7}), {5, -3, 1}};
  for (StampedPose& pose : trajectory) {
    pose.T_world_camera.t *= 0.3;
    pose.T_world_camera = T * pose.T_world_camera;
  }
  return trajectory;
}

TEST(FalsePoses, ThereAreNoneInTheSameWayAtAnotherScale) {
  const Trajectory truth = HalfCircle();
  const FalsePoses found = FindFalsePoses(truth, Elsewhere(truth), Alignment::kSim3);
  EXPECT_TRUE(found.wrong.empty());
  EXPECT_EQ(found.pairs.size(), 200u);
  EXPECT_NEAR(found.path, 2 * std::numbers::pi, 0.13);  // whole steps only
  EXPECT_LT(found.metres.max, 1e-9);
  EXPECT_LT(found.degrees.max, 1e-5);
  EXPECT_NEAR(found.scale_drift, 1, 1e-9);
}

TEST(FalsePoses, AreThoseFurtherAwayThanATenthOfThePath) {
  const Trajectory truth = HalfCircle();
  Trajectory estimate = truth;
  for (int i = 50; i < 55; ++i) estimate[i].T_world_camera.t.y() += 0.5;  // 8 %: correct
  EXPECT_TRUE(FindFalsePoses(truth, Elsewhere(estimate), Alignment::kSim3).wrong.empty());
  for (int i = 50; i < 55; ++i) estimate[i].T_world_camera.t.y() += 0.5;  // 16 %
  EXPECT_EQ(FindFalsePoses(truth, Elsewhere(estimate), Alignment::kSim3).wrong,
            (std::vector<int>{50, 51, 52, 53, 54}));
}

TEST(FalsePoses, AreThoseTurnedByMoreThanTenDegrees) {
  const Trajectory truth = HalfCircle();
  Trajectory estimate = truth;
  const auto turn = [&](int i, double degrees) {
    Eigen::Matrix3d& R = estimate[i].T_world_camera.R;
    R = (R * ExpSo3({0, 0, degrees * kDegree})).eval();
  };
  turn(20, 9);
  turn(120, 12);
  EXPECT_EQ(FindFalsePoses(truth, Elsewhere(estimate), Alignment::kSim3).wrong,
            std::vector<int>{120});
}

TEST(FalsePoses, ARollAboutAStraightWayIsNotTakenFromItsPositions) {
  const Trajectory truth = StraightOn();
  Random random(3);
  Trajectory estimate = truth;
  for (StampedPose& pose : estimate)  // positions alone would rotate the alignment about the path
    pose.T_world_camera.t += Eigen::Vector3d(random.Uniform(), random.Uniform(), 0) * 1e-3;
  const FalsePoses found = FindFalsePoses(truth, Elsewhere(estimate), Alignment::kSim3);
  EXPECT_TRUE(found.wrong.empty());
  EXPECT_LT(found.degrees.max, 0.01);
}

TEST(FalsePoses, TremblingIsNoPath) {
  Random random(5);
  Trajectory truth;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d p(random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1));
    truth.push_back({i / 30.0, {Eigen::Matrix3d::Identity(), 0.02 * p}, ""});
  }
  // An unrelated estimate: aligned to the jitter it shrinks to nearly nothing, and is wrong by more
  // than a tenth of the short path.
  const FalsePoses found = FindFalsePoses(truth, StraightOn(), Alignment::kSim3, {.max_dt = 0.05});
  EXPECT_LT(found.path, 0.08);
  EXPECT_GT(found.wrong.size(), 70u);
}

TEST(FalsePoses, ScaleThatShrinksOnTheWayIsTold) {
  const Trajectory truth = StraightOn();
  Trajectory estimate = truth;
  double z = 0;
  for (size_t i = 1; i < estimate.size(); ++i) {
    z += i < 50 ? 0.8 : 0.4;
    estimate[i].T_world_camera.t.z() = z;
  }
  const FalsePoses found = FindFalsePoses(truth, Elsewhere(estimate), Alignment::kSim3);
  EXPECT_NEAR(found.scale_drift, 2, 0.01);
  // After alignment its error is below a tenth of the path: inaccurate but not wrong.
  EXPECT_TRUE(found.wrong.empty());
}

TEST(FalsePoses, OfACameraThatStoodStillNoneIsWrongByItsPlace) {
  Trajectory truth = StraightOn();
  for (StampedPose& pose : truth) pose.T_world_camera.t.setZero();
  const FalsePoses found = FindFalsePoses(truth, StraightOn(), Alignment::kSim3);
  EXPECT_EQ(found.path, 0);
  EXPECT_TRUE(found.wrong.empty());
}

TEST(FalsePoses, NothingToCompareIsNothingWrong) {
  const Trajectory truth = HalfCircle();
  EXPECT_TRUE(FindFalsePoses(truth, {}, Alignment::kSim3).wrong.empty());
  EXPECT_TRUE(
      FindFalsePoses(truth, {truth.begin(), truth.begin() + 2}, Alignment::kSim3).wrong.empty());
  FalsePoseSettings settings;
  settings.degrees = 0;
  EXPECT_THROW(FindFalsePoses(truth, truth, Alignment::kSim3, settings), Error);
}

}  // namespace
}  // namespace alidade::false_poses_test
