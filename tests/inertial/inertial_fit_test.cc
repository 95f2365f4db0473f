// The fit of scale, gravity, biases, rotation, lever arm and clock against a motion in closed form
// and, with ALIDADE_DATA, against three real flights.
#include "alidade/inertial/inertial_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "alidade/base/random.h"
#include "alidade/inertial/rotation_match.h"
#include "support/inertial_problem.h"

namespace alidade {
namespace {

double Degrees(double radians) { return radians * 180 / M_PI; }

TEST(InertialFit, FindsEverythingOfAnUnknownSensor) {
  InertialTruth truth;
  for (const double scale : {0.4, 7.0}) {
    truth.scale = scale;
    const InertialProblem problem(truth, 8, 1);
    const InertialFit fit = FitInertial(problem.poses, problem.samples, {});
    ASSERT_TRUE(fit.solved);
    EXPECT_NEAR(fit.scale / truth.scale, 1, 4 * fit.scale_sigma);
    EXPECT_LT(fit.scale_sigma, 0.01);
    const Eigen::Vector3d down = truth.R_map_world * SmoothMotion::Gravity().normalized();
    EXPECT_LT(std::acos(fit.gravity.normalized().dot(down)), 4 * fit.gravity_sigma);
    EXPECT_LT(Degrees(fit.gravity_sigma), 0.5);
    EXPECT_LT(RotationAngle(fit.model.T_camera_imu, truth.T_camera_imu), 4 * fit.rotation_sigma);
    EXPECT_LT(Degrees(fit.rotation_sigma), 0.2);
    EXPECT_NEAR(fit.model.time_offset, truth.time_offset, 4 * fit.time_offset_sigma);
    EXPECT_LT(fit.time_offset_sigma, 0.001);
    EXPECT_LT((fit.model.T_camera_imu.t - truth.T_camera_imu.t).norm(), 4 * fit.translation_sigma);
    EXPECT_LT((fit.states.back().bias.gyro - truth.bias.gyro).norm(), 0.003);
    EXPECT_LT((fit.states.back().bias.accel - truth.bias.accel).norm(), 0.1);
    EXPECT_NEAR(fit.noise_factor, 1, 0.15);
  }
}

TEST(InertialFit, StandardDeviationsAreThoseOfManyRuns) {
  InertialTruth truth;
  double scale = 0, offset = 0;
  constexpr int kRuns = 40;
  for (int run = 0; run < kRuns; ++run) {
    const InertialProblem problem(truth, 4, 10 + run);
    const InertialFit fit = FitInertial(problem.poses, problem.samples, {});
    ASSERT_TRUE(fit.solved) << run;
    scale += std::pow((fit.scale / truth.scale - 1) / fit.scale_sigma, 2) / kRuns;
    offset +=
        std::pow((fit.model.time_offset - truth.time_offset) / fit.time_offset_sigma, 2) / kRuns;
  }
  // A mean of 40 squares has a standard error of 0.22.
  EXPECT_NEAR(scale, 1, 0.7);
  EXPECT_NEAR(offset, 1, 0.7);
}

TEST(InertialFit, HoldsWhereTheSensorWasSilent) {
  const InertialTruth truth;
  InertialProblem problem(truth, 10, 2);
  std::erase_if(problem.samples, [](const ImuSample& s) { return s.time > 3 && s.time < 6; });
  const RotationMatch match = MatchRotations(problem.poses, problem.samples, {});
  EXPECT_FALSE(match.Contradicts());
  EXPECT_LT(match.residual, 0.1 * match.turning);
  const InertialFit fit = FitInertial(problem.poses, problem.samples, {});
  ASSERT_TRUE(fit.solved);
  EXPECT_LT(fit.noise_factor, 1.3);
  EXPECT_LT(fit.scale_sigma, 0.02);
  EXPECT_NEAR(fit.scale / truth.scale, 1, 4 * fit.scale_sigma);
  EXPECT_LT((fit.states.back().bias.gyro - truth.bias.gyro).norm(), 0.003);
}

TEST(InertialFit, TellsThatAnEvenMotionHasNoScale) {
  const InertialTruth truth;
  InertialProblem problem(truth, 6, 3);
  // At a constant velocity without turning nothing tells how long the path is.
  Random random(5, 1);
  const Eigen::Matrix3d R = truth.T_camera_imu.R.transpose();
  for (ImuSample& sample : problem.samples) {
    sample.angular_rate = truth.bias.gyro;
    sample.specific_force = -SmoothMotion::Gravity() + truth.bias.accel;
    for (int k = 0; k < 3; ++k) sample.specific_force[k] += 0.28 * random.Gaussian();
  }
  for (TimedPose& pose : problem.poses) {
    pose.T_world_camera = {R, Eigen::Vector3d(0.5 * pose.time, 0, 0) / truth.scale};
  }
  ImuModel model;
  model.T_camera_imu = truth.T_camera_imu;
  model.rotation_known = model.translation_known = model.time_offset_known = true;
  const InertialFit fit = FitInertial(problem.poses, problem.samples, model);
  EXPECT_TRUE(!fit.solved || fit.scale_sigma > 0.3) << fit.scale_sigma;
}

TEST(RotationMatch, TellsReadingsOfAnotherMotion) {
  const InertialTruth truth;
  InertialProblem problem(truth, 8, 4);
  const RotationMatch right = MatchRotations(problem.poses, problem.samples, {});
  EXPECT_LT(RotationAngle(Se3{right.R_camera_imu, {}}, truth.T_camera_imu), 0.02);
  EXPECT_NEAR(right.time_offset, truth.time_offset, 0.004);
  EXPECT_LT(right.residual, 0.1 * right.turning);
  EXPECT_GT(right.second_axis, 0.1);
  for (ImuSample& sample : problem.samples)
    sample.angular_rate = SmoothMotion::TurnRate(2.3 * sample.time + 1);
  const RotationMatch other = MatchRotations(problem.poses, problem.samples, {});
  EXPECT_GT(other.residual, 0.5 * other.turning);
}

std::vector<std::vector<double>> NumbersIn(const std::string& path) {
  std::ifstream file(path);
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    for (char& c : line) c = c == ',' ? ' ' : c;
    std::istringstream text(line);
    rows.emplace_back();
    for (double value; text >> value;) rows.back().push_back(value);
  }
  return rows;
}

// True poses with noise, as of a map of one camera, and a real sensor of which nothing is known.
// The quaternions of these files are (w, -x, -y, -z) of T_world_camera, not (x, y, z, w) as their
// README says: only so do they agree with the gyroscope and with gravity.
TEST(InertialFit, HoldsOnRealFlights) {
  const char* data = std::getenv("ALIDADE_DATA");
  if (!data) GTEST_SKIP() << "ALIDADE_DATA is not set";
  Eigen::Matrix3d R_imu_camera;
  R_imu_camera << 0.0148655, -0.9998809, 0.0041403, 0.9995572, 0.0149672, 0.0257155, -0.0257744,
      0.0037562, 0.9996607;
  for (const std::string flight : {"V102", "MH04"}) {
    const std::string folder = std::string(data) + "/euroc_flights/" + flight;
    std::vector<ImuSample> samples;
    for (const auto& r : NumbersIn(folder + "/imu.csv"))
      samples.push_back({r[0], {r[1], r[2], r[3]}, {r[4], r[5], r[6]}});
    Random random(1, 1);
    std::vector<TimedPose> poses;
    for (const auto& r : NumbersIn(folder + "/groundtruth.txt")) {
      if (r[0] < 30 || r[0] > 45 || (!poses.empty() && r[0] - poses.back().time < 0.099)) continue;
      TimedPose pose;
      pose.time = r[0];
      pose.T_world_camera = Se3::FromQuaternion({r[4], -r[5], -r[6], -r[7]}, {r[1], r[2], r[3]});
      for (int k = 0; k < 3; ++k) pose.T_world_camera.t[k] += 0.005 * random.Gaussian();
      pose.T_world_camera.t /= 2.5;
      pose.covariance.diagonal() << Eigen::Vector3d::Constant(4e-6),
          Eigen::Vector3d::Constant(1e-6);
      poses.push_back(pose);
    }
    ASSERT_GT(poses.size(), 100u);
    const InertialFit fit = FitInertial(poses, samples, {});
    ASSERT_TRUE(fit.solved) << flight;
    EXPECT_NEAR(fit.scale / 2.5, 1, 0.03) << flight;
    EXPECT_LT(Degrees(std::acos(-fit.gravity.normalized().z())), 0.7) << flight;
    EXPECT_LT(Degrees(RotationAngle(fit.model.T_camera_imu, Se3{R_imu_camera.transpose(), {}})),
              0.7);
    EXPECT_NEAR(fit.model.time_offset, 0, 0.003) << flight;
    EXPECT_LT((fit.states.back().bias.gyro - Eigen::Vector3d(-0.002, 0.021, 0.077)).norm(), 0.004);
    EXPECT_LT(fit.scale_sigma, 0.02) << flight;
  }
}

}  // namespace
}  // namespace alidade
