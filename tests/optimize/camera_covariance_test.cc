// Covariance of a camera in a bundle problem, compared with the scatter of solutions.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <optional>
#include <random>

#include "alidade/optimize/bundle_covariance.h"
#include "problems/bundle_problem.h"
#include "support/aligned_poses.h"

namespace alidade::camera_covariance_test {
namespace {

constexpr double kNoise = 0.5;  // pixels
constexpr int kTries = 200;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// A problem at the truth, with exact observations, and one fixed camera.
BundleProblem Exact(double stereo) {
  BundleProblem problem = MakeBundleProblem({.free_cameras = 4,
                                             .points = 60,
                                             .stereo = stereo,
                                             .noise_px = 0,
                                             .point_error = 0,
                                             .camera_error = 0,
                                             .rotation_error = 0,
                                             .seed = 5});
  problem.fixed.assign(problem.fixed.size(), 0);
  problem.fixed[0] = 1;
  return problem;
}

BundleProblem WithNoise(const BundleProblem& exact, int seed) {
  BundleProblem problem = exact;
  std::mt19937_64 random(static_cast<uint64_t>(seed));
  std::normal_distribution<double> noise(0, kNoise);
  for (BundleObservation& o : problem.observations) {
    const double right = noise(random);
    o.pixel += Eigen::Vector3d(noise(random), noise(random), 0);
    // The disparity has noise of its own.
    o.pixel.z() = std::isnan(o.pixel.z()) ? kNaN : o.pixel.z() + right;
    o.inv_sigma2 = 1 / (kNoise * kNoise);
    o.inv_sigma2_right = 1 / (kNoise * kNoise);
  }
  return problem;
}

class CameraCovarianceOf : public testing::TestWithParam<double> {};

// Root mean square of error / standard deviation over many noises: 1 where the covariance is right.
// With one camera the scale is that which keeps the mean distance from the fixed camera.
TEST_P(CameraCovarianceOf, IsTheScatterOfSolutions) {
  const BundleProblem exact = Exact(GetParam());
  const int camera = 3;
  double sum = 0;
  int count = 0;
  for (int seed = 1; seed <= kTries; ++seed) {
    BundleProblem problem = WithNoise(exact, seed);
    AdjustBundle(problem, {.max_iterations = 50, .min_relative_decrease = 1e-12});
    const std::optional<Matrix6d> covariance = CameraCovariance(problem, {}, camera);
    ASSERT_TRUE(covariance);
    const Se3 fixed = exact.T_camera_world[0].Inverse();
    double along = 0, length2 = 0;
    for (size_t i = 1; i < exact.T_camera_world.size(); ++i) {
      const Eigen::Vector3d found = problem.T_camera_world[i].Inverse().t - fixed.t;
      along += found.dot(exact.T_camera_world[i].Inverse().t - fixed.t);
      length2 += found.squaredNorm();
    }
    Se3 real = exact.T_camera_world[camera].Inverse();
    if (GetParam() == 0) real.t = fixed.t + length2 / along * (real.t - fixed.t);
    const Vector6d xi = (problem.T_camera_world[camera] * real).Log();
    sum += xi.dot(covariance->inverse() * xi);
    count += 6;
  }
  EXPECT_NEAR(std::sqrt(sum / count), 1, 0.12);
}

// The same of all cameras after the alignment; no camera is fixed.
TEST_P(CameraCovarianceOf, OfAllIsTheScatterAfterAlignment) {
  constexpr double kLength = 3;
  BundleProblem exact = Exact(GetParam());
  exact.fixed.assign(exact.fixed.size(), 0);
  std::vector<Se3> real;
  for (const Se3& T : exact.T_camera_world) real.push_back(T.Inverse());
  double sum = 0;
  int count = 0;
  for (int seed = 1; seed <= kTries; ++seed) {
    BundleProblem problem = WithNoise(exact, seed);
    AdjustBundle(problem, {.max_iterations = 50, .min_relative_decrease = 1e-12});
    std::vector<Se3> estimated;
    for (const Se3& T : problem.T_camera_world) estimated.push_back(T.Inverse());
    const Sim3 T = AlignmentOf(estimated, real, kLength, GetParam() == 0);
    const std::vector<Matrix6d> covariances = CameraCovariances(problem, {}, kLength);
    for (size_t i = 0; i < real.size(); ++i) {
      const Vector6d xi = ErrorAfter(T, estimated[i], real[i]);
      for (int k = 0; k < 6; ++k) sum += xi[k] * xi[k] / covariances[i](k, k);
      count += 6;
    }
  }
  EXPECT_NEAR(std::sqrt(sum / count), 1, 0.12);
}

INSTANTIATE_TEST_SUITE_P(Sensors, CameraCovarianceOf, testing::Values(0.0, 1.0),
                         [](const auto& stereo) { return stereo.param > 0 ? "Stereo" : "Mono"; });

TEST(CameraCovariance, IsOfFreeCamerasWithObservationsOnly) {
  BundleProblem problem = WithNoise(Exact(1), 1);
  EXPECT_TRUE(CameraCovariance(problem, {}, 1));
  EXPECT_FALSE(CameraCovariance(problem, {}, 0));  // fixed
  std::erase_if(problem.observations, [](const BundleObservation& o) { return o.camera == 1; });
  EXPECT_FALSE(CameraCovariance(problem, {}, 1));
}

// A pose that is not observed has none, and the others keep theirs.
TEST(CameraCovariances, AreZeroWhereNothingIsObserved) {
  BundleProblem problem = WithNoise(Exact(1), 1);
  problem.fixed.assign(problem.fixed.size(), 0);
  std::erase_if(problem.observations, [](const BundleObservation& o) { return o.camera == 1; });
  const std::vector<Matrix6d> covariances = CameraCovariances(problem, {}, 1);
  EXPECT_TRUE(covariances[1].isZero());
  EXPECT_GT(covariances[2].diagonal().minCoeff(), 0);
  EXPECT_TRUE(CameraCovariances(problem, {}, 1, 10).empty());  // too much work
}

TEST(CameraCovariance, IsUnknownWithoutSpareObservations) {
  BundleProblem problem = WithNoise(Exact(0), 1);
  std::erase_if(problem.observations, [](const BundleObservation& o) { return o.point > 0; });
  EXPECT_FALSE(CameraCovariance(problem, {}, 1));
}

}  // namespace
}  // namespace alidade::camera_covariance_test
