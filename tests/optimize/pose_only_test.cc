#include "alidade/optimize/pose_only.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>

#include "alidade/base/error.h"
#include "ceres_reprojection.h"
#include "problems/pose_problem.h"
#include "support/expect_error.h"

namespace alidade::pose_only_test {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

double PositionError(const Se3& a, const Se3& b) { return (a.Inverse().t - b.Inverse().t).norm(); }

// Minimizes the plain squares over the matches that are `used`.
std::pair<Se3, double> SolveWithCeres(const Camera& camera, const Se3& start,
                                      const std::vector<PoseMatch>& matches,
                                      const std::vector<bool>& used) {
  Eigen::Matrix<double, 6, 1> pose = ToCeresPose(start);
  std::vector<Eigen::Vector3d> points;
  for (const PoseMatch& m : matches) points.push_back(m.p_world);
  ceres::Problem problem;
  for (size_t i = 0; i < matches.size(); ++i) {
    if (!used[i]) continue;
    problem.AddResidualBlock(MakeCeresReprojection(camera, matches[i]), nullptr, pose.data(),
                             points[i].data());
    problem.SetParameterBlockConstant(points[i].data());
  }
  ceres::Solver::Options options;
  options.function_tolerance = 1e-16;
  options.parameter_tolerance = 1e-14;
  options.gradient_tolerance = 1e-14;
  options.max_num_iterations = 100;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return {FromCeresPose(pose), summary.final_cost};
}

TEST(OptimizePose, ReturnsToTruthFromTenDegreesAwayAmongThirtyPercentOutliers) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    const PoseProblem problem =
        MakePoseProblem({.matches = 200, .stereo = 0.5, .outliers = 0.3, .seed = seed});
    Random random(seed, 1);
    Vector6d away;
    away << RandomVector(random, 0.1), RandomVector(random, 1).normalized() * 10 * kDegree;
    const PoseOnlyResult result =
        OptimizePose(problem.camera, Se3::Exp(away) * problem.truth, problem.matches);
    // 140 matches with sigma 1 to 3.6 px at f = 520 px: 0.1 degrees is 0.9 px, several standard
    // deviations of their mean.
    EXPECT_LT(RotationAngle(result.T_camera_world, problem.truth), 0.2 * kDegree) << seed;
    EXPECT_LT(PositionError(result.T_camera_world, problem.truth), 0.02) << seed;
    int wrong = 0, lost = 0;
    for (size_t i = 0; i < problem.matches.size(); ++i) {
      wrong += result.inlier[i] && problem.outlier[i];
      lost += !result.inlier[i] && !problem.outlier[i];
    }
    EXPECT_LE(wrong, 3) << seed;  // an outlier may be consistent by chance
    EXPECT_LE(lost, 20) << seed;  // the gate keeps 95 % of 140: 7 expected
  }
}

TEST(OptimizePose, AgreesWithCeresOnTheInliersItFound) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    const double stereo = seed % 3 * 0.5;
    const PoseProblem problem =
        MakePoseProblem({.matches = 101, .stereo = stereo, .outliers = 0.2, .seed = seed});
    Random random(seed, 1);
    const Se3 start = Se3::Exp(RandomIncrement(random, 0.02, 0.02)) * problem.truth;
    const PoseOnlyResult ours = OptimizePose(problem.camera, start, problem.matches);
    const auto [pose, cost] = SolveWithCeres(problem.camera, start, problem.matches, ours.inlier);
    EXPECT_NEAR(ours.cost, cost, 1e-6 * cost) << seed;
    EXPECT_LT(RotationAngle(ours.T_camera_world, pose), 1e-4 * kDegree) << seed;
    EXPECT_LT(PositionError(ours.T_camera_world, pose), 1e-5) << seed;
    EXPECT_EQ(ours.inliers, std::count(ours.inlier.begin(), ours.inlier.end(), true));
  }
}

TEST(OptimizePose, InformationIsThatOfAutomaticDerivatives) {
  const PoseProblem problem = MakePoseProblem({.matches = 60, .seed = 3});
  const PoseOnlyResult result = OptimizePose(problem.camera, problem.truth, problem.matches);
  Matrix6d expected = Matrix6d::Zero();
  using Jet = ceres::Jet<double, 6>;
  for (size_t i = 0; i < problem.matches.size(); ++i) {
    if (!result.inlier[i]) continue;
    const PoseMatch& m = problem.matches[i];
    const Eigen::Vector3d p = result.T_camera_world * m.p_world;
    // Exp(xi) at xi = 0 as a rotation vector and a translation, both exact to first order.
    Jet pose[6], point[3], residual[3];
    for (int d = 0; d < 3; ++d) {
      pose[d] = Jet(0, 3 + d);
      pose[3 + d] = Jet(0, d);
      point[d] = Jet(p[d]);
    }
    const bool stereo = std::isfinite(m.pixel.z());
    if (stereo) {
      CeresReprojection<true>{problem.camera, m.pixel, m.inv_sigma2, m.inv_sigma2_right}(
          pose, point, residual);
    } else {
      CeresReprojection<false>{problem.camera, m.pixel, m.inv_sigma2, m.inv_sigma2_right}(
          pose, point, residual);
    }
    for (int row = 0; row < (stereo ? 3 : 2); ++row) {
      expected += residual[row].v * residual[row].v.transpose();
    }
  }
  // The information is from the last step but one, with a relative cost difference of 1e-7.
  EXPECT_LT((result.information - expected).norm(), 1e-6 * expected.norm());
}

// Ceres' covariance of the same pose, for left increments Exp(xi) with xi = (translation;
// rotation).
Matrix6d CovarianceOfCeres(const Camera& camera, const PoseOnlyResult& result,
                           const std::vector<PoseMatch>& matches) {
  // Landmarks are transformed to the camera frame, so that the pose parameters (rotation vector,
  // translation) are the increment around zero.
  Eigen::Matrix<double, 6, 1> pose = Eigen::Matrix<double, 6, 1>::Zero();
  std::vector<Eigen::Vector3d> points;
  for (const PoseMatch& m : matches) points.push_back(result.T_camera_world * m.p_world);
  ceres::Problem problem;
  for (size_t i = 0; i < matches.size(); ++i) {
    if (!result.inlier[i]) continue;
    problem.AddResidualBlock(MakeCeresReprojection(camera, matches[i]), nullptr, pose.data(),
                             points[i].data());
    problem.SetParameterBlockConstant(points[i].data());
  }
  ceres::Covariance covariance({});
  const std::vector<std::pair<const double*, const double*>> block = {{pose.data(), pose.data()}};
  EXPECT_TRUE(covariance.Compute(block, &problem));
  Eigen::Matrix<double, 6, 6, Eigen::RowMajor> found;
  covariance.GetCovarianceBlock(pose.data(), pose.data(), found.data());
  Matrix6d ordered;  // translation first
  ordered << found.bottomRightCorner<3, 3>(), found.bottomLeftCorner<3, 3>(),
      found.topRightCorner<3, 3>(), found.topLeftCorner<3, 3>();
  return ordered;
}

TEST(OptimizePose, CovarianceIsCeresTimesTheResidualsVariance) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    // Half of the assumed noise, so that the gate removes nothing.
    const PoseProblem problem =
        MakePoseProblem({.matches = 150, .stereo = 0.5, .noise_px = 0.5, .seed = seed});
    const PoseOnlyResult result = OptimizePose(problem.camera, problem.truth, problem.matches);
    int measured = 0;
    for (size_t i = 0; i < problem.matches.size(); ++i) {
      if (result.inlier[i]) measured += std::isfinite(problem.matches[i].pixel.z()) ? 3 : 2;
    }
    EXPECT_EQ(result.measured, measured);
    const double factor = 2 * result.cost / (measured - 6);
    EXPECT_NEAR(factor, 0.25, 0.05);
    const Matrix6d expected = factor * CovarianceOfCeres(problem.camera, result, problem.matches);
    EXPECT_LT((result.covariance - expected).norm(), 1e-3 * expected.norm()) << seed;
  }
}

// Spread of the errors over many noise samples: normalized by each reported covariance, the mean
// square is 1.
TEST(OptimizePose, CovarianceIsTheSpreadOfTheErrors) {
  for (const double noise : {0.3, 1.0}) {  // pixels; the latter reaches the gate
    for (const double outliers : {0.0, 0.2}) {
      double sum = 0;
      constexpr int kDraws = 400;
      for (uint64_t seed = 1; seed <= kDraws; ++seed) {
        const PoseProblem problem = MakePoseProblem(
            {.matches = 100, .stereo = 0.5, .outliers = outliers, .noise_px = noise, .seed = seed});
        const PoseOnlyResult result = OptimizePose(problem.camera, problem.truth, problem.matches);
        const Vector6d xi = (problem.truth * result.T_camera_world.Inverse()).Log();
        sum += xi.dot(result.covariance.inverse() * xi) / 6;
      }
      // The mean square of 2400 standard normal numbers is 1 ± 0.03; outliers within the gate
      // increase it slightly.
      EXPECT_NEAR(std::sqrt(sum / kDraws), 1, 0.1) << noise << " px, outliers " << outliers;
    }
  }
}

// In the camera frame the correlations have a known structure for distant points without depth.
TEST(OptimizePose, CovarianceIsInTheCamerasFrame) {
  const PoseProblem problem = MakePoseProblem(
      {.matches = 200, .stereo = 0, .noise_px = 0.5, .min_depth = 20, .max_depth = 25, .seed = 4});
  const Matrix6d covariance =
      OptimizePose(problem.camera, problem.truth, problem.matches).covariance;
  // Distant points within 30° of the axis: translation along x and rotation about y are strongly
  // correlated.
  EXPECT_GT(covariance(0, 0), 0);
  EXPECT_GT(std::abs(covariance(0, 4)) / std::sqrt(covariance(0, 0) * covariance(4, 4)), 0.9);
  EXPECT_LT(std::abs(covariance(0, 3)) / std::sqrt(covariance(0, 0) * covariance(3, 3)), 0.5);
}

TEST(OptimizePose, CovarianceIsZeroWhereMatchesDoNotTellAPose) {
  PoseProblem problem = MakePoseProblem({.matches = 50, .stereo = 0, .seed = 8});
  EXPECT_TRUE(OptimizePose(problem.camera, problem.truth, std::span(problem.matches).first(3))
                  .covariance.isZero());  // six coordinates: no redundancy
  for (PoseMatch& m : problem.matches) m = problem.matches[0];
  EXPECT_TRUE(OptimizePose(problem.camera, problem.truth, problem.matches).covariance.isZero());
}

TEST(OptimizePose, LooksPastMatchesThatAreNotNumbers) {
  PoseProblem problem = MakePoseProblem({.matches = 80, .noise_px = 0, .seed = 5});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  problem.matches[0].p_world.x() = nan;
  problem.matches[1].p_world.z() = inf;
  problem.matches[2].pixel.x() = nan;
  problem.matches[3].pixel.y() = -inf;
  problem.matches[4].inv_sigma2 = nan;
  problem.matches[5].inv_sigma2 = 0;
  problem.matches[6].inv_sigma2 = inf;
  Vector6d away;
  away << 0.05, -0.05, 0.02, 0.02, 0.01, -0.02;
  const PoseOnlyResult result =
      OptimizePose(problem.camera, Se3::Exp(away) * problem.truth, problem.matches);
  EXPECT_EQ(result.inliers, 73);
  for (int i = 0; i < 7; ++i) EXPECT_FALSE(result.inlier[i]) << i;
  EXPECT_LT(RotationAngle(result.T_camera_world, problem.truth), 1e-7);
  EXPECT_LT(PositionError(result.T_camera_world, problem.truth), 1e-7);
  EXPECT_LT(result.cost, 1e-6);
}

TEST(OptimizePose, APointBehindTheCameraIsNeverAnInlierAndStopsNothing) {
  PoseProblem problem = MakePoseProblem({.matches = 60, .noise_px = 0.5, .seed = 6});
  // Mirrored through the optical center: the same pixel, but behind the camera.
  const Se3 T_world_camera = problem.truth.Inverse();
  for (int i = 0; i < 10; ++i) {
    const Eigen::Vector3d p = problem.truth * problem.matches[i].p_world;
    problem.matches[i].p_world = T_world_camera * Eigen::Vector3d(-p);
    problem.matches[i].pixel.z() = std::numeric_limits<double>::quiet_NaN();
  }
  // Points just in front of the camera at the start, behind it at the solution.
  Vector6d away = Vector6d::Zero();
  away << 0.02, 0, 0.1, 0.02, -0.03, 0.01;
  const Se3 start = Se3::Exp(away) * problem.truth;
  for (int i = 10; i < 15; ++i) {
    problem.matches[i].p_world = start.Inverse() * Eigen::Vector3d(0.01 * i, 0, 0.05);
  }
  const PoseOnlyResult result = OptimizePose(problem.camera, start, problem.matches);
  for (int i = 0; i < 15; ++i) EXPECT_FALSE(result.inlier[i]) << i;
  EXPECT_GE(result.inliers, 38);
  EXPECT_LT(RotationAngle(result.T_camera_world, problem.truth), 0.2 * kDegree);
}

TEST(OptimizePose, FewerThanThreeMatchesGiveBackTheStart) {
  const PoseProblem problem = MakePoseProblem({.matches = 2, .seed = 7});
  const PoseOnlyResult result = OptimizePose(problem.camera, problem.truth, problem.matches);
  EXPECT_EQ(result.T_camera_world.R, problem.truth.R);
  EXPECT_EQ(result.T_camera_world.t, problem.truth.t);
  EXPECT_EQ(result.inliers, 0);
  EXPECT_EQ(result.inlier, std::vector<bool>(2, false));
  EXPECT_EQ(OptimizePose(problem.camera, problem.truth, {}).inliers, 0);
}

TEST(OptimizePose, DegenerateMatchesGiveAFinitePose) {
  PoseProblem problem = MakePoseProblem({.matches = 50, .stereo = 0, .seed = 8});
  for (PoseMatch& m : problem.matches)
    m = problem.matches[0];  // a single point: 4 degrees of freedom remain
  const PoseOnlyResult result = OptimizePose(problem.camera, problem.truth, problem.matches);
  EXPECT_TRUE(result.T_camera_world.R.allFinite());
  EXPECT_TRUE(result.T_camera_world.t.allFinite());
  EXPECT_LT(PositionError(result.T_camera_world, problem.truth), 0.2);
}

TEST(OptimizePose, SettingsThatCannotBeAreNamed) {
  const auto complaint = ComplaintAbout<PoseOnlySettings>;
  EXPECT_EQ(complaint({}), "");
  EXPECT_NE(complaint({.max_iterations = 0}).find("max_iterations"), std::string::npos);
  EXPECT_NE(complaint({.rounds = 0}).find("rounds"), std::string::npos);
  EXPECT_NE(complaint({.huber_mono = -1}).find("huber_mono"), std::string::npos);
  EXPECT_NE(complaint({.huber_stereo = std::nan("")}).find("huber_stereo"), std::string::npos);
}

}  // namespace
}  // namespace alidade::pose_only_test
