// Dead reckoning against a motion in closed form: its errors are as large as its covariance says.
#include "alidade/inertial/motion_belief.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "support/inertial_problem.h"

namespace alidade {
namespace {

// xi of TimedPose::covariance, from the believed to the true pose.
Vector6d ErrorOf(const TimedPose& pose, const Se3& truth) {
  const Se3 error = pose.T_world_camera.Inverse() * truth;
  Vector6d xi;
  xi << error.t, LogSo3(error.R);
  return xi;
}

// Mean of xi' covariance⁻¹ xi / 6 over many runs: 1 where the covariance is right.
struct Normalized {
  double sum = 0;
  int count = 0;
  void Add(const TimedPose& pose, const Se3& truth) {
    const Vector6d xi = ErrorOf(pose, truth);
    sum += xi.dot(pose.covariance.llt().solve(xi)) / 6;
    ++count;
  }
  double Mean() const { return sum / count; }
};

TEST(MotionBelief, ErrorsOfDeadReckoningAreAsLargeAsItSays) {
  const InertialTruth truth;
  Normalized at_first, at_last, after_1, after_3, corrected;
  constexpr int kRuns = 30;
  for (int run = 0; run < kRuns; ++run) {
    const InertialProblem problem(truth, 6, 100 + run, 4);
    const InertialFit fit = FitInertial(problem.poses, problem.samples, {});
    ASSERT_TRUE(fit.solved) << run;
    const auto add = [&](Normalized& to, const MotionBelief& belief) {
      to.Add(belief.Camera(problem.samples), truth.CameraAt(belief.time));
    };
    add(at_first, fit.first);
    add(at_last, fit.last);
    add(after_1, fit.last.At(fit.last.time + 1, problem.samples));
    // In steps it is the same, but for the second order of the steps.
    MotionBelief belief = fit.last;
    for (int step = 0; step < 30; ++step) belief = belief.At(belief.time + 0.1, problem.samples);
    add(after_3, belief);
    TimedPose seen = fit.last.At(fit.last.time + 3, problem.samples).Camera(problem.samples);
    EXPECT_LT((seen.T_world_camera.t - belief.Camera(problem.samples).T_world_camera.t).norm(),
              0.02);
    Random random(7 + run, 1);
    seen.T_world_camera = truth.CameraAt(belief.time);
    for (int k = 0; k < 3; ++k) seen.T_world_camera.t[k] += 0.01 * random.Gaussian();
    seen.covariance = 1e-6 * Matrix6d::Identity();
    seen.covariance.diagonal().head<3>().setConstant(1e-4);
    ASSERT_TRUE(belief.See(seen, problem.samples));
    add(corrected, belief);
    EXPECT_LT(belief.Camera(problem.samples).covariance(0, 0), 1.01e-4);
  }
  // A mean of 180 squares has a standard error of 0.11, and poses of one run share their errors.
  for (const Normalized* each : {&at_first, &at_last, &after_1, &after_3})
    EXPECT_NEAR(each->Mean(), 1, 0.5);
  EXPECT_LT(corrected.Mean(), 1.5);
}

TEST(MotionBelief, StaysARotationWhenItsWorldIsCorrectedAgainAndAgain) {
  const InertialTruth truth;
  const InertialProblem problem(truth, 4, 1, 2);
  MotionBelief belief = FitInertial(problem.poses, problem.samples, {}).last;
  for (int k = 0; k < 200; ++k) {
    // As a keyframe that did not move: its pose by the belief, and by the map.
    const Se3 T = belief.state.T_world_imu;
    belief.Move(T * T.Inverse());
  }
  const Eigen::Matrix3d& R = belief.state.T_world_imu.R;
  EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_LT((belief.state.T_world_imu.t -
             FitInertial(problem.poses, problem.samples, {}).last.state.T_world_imu.t)
                .norm(),
            1e-9);
}

TEST(MotionBelief, IsTheSameInAnotherWorld) {
  const InertialTruth truth;
  const InertialProblem problem(truth, 4, 1, 2);
  const MotionBelief here = FitInertial(problem.poses, problem.samples, {}).last;
  const Se3 T{ExpSo3({0.4, -1.2, 0.8}), {3, -2, 1}};
  MotionBelief there = here;
  there.Move(T);
  const TimedPose a = here.At(here.time + 1.5, problem.samples).Camera(problem.samples);
  const TimedPose b = there.At(there.time + 1.5, problem.samples).Camera(problem.samples);
  const Se3 carried{T.R, T.t / here.common.scale};
  EXPECT_LT(((carried * a.T_world_camera).t - b.T_world_camera.t).norm(), 1e-9);
  EXPECT_LT(RotationAngle(carried * a.T_world_camera, b.T_world_camera), 1e-9);
  EXPECT_LT((a.covariance - b.covariance).norm(), 1e-9 * a.covariance.norm() + 1e-15);
}

}  // namespace
}  // namespace alidade
