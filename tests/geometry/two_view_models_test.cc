#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <vector>

#include "alidade/base/random.h"
#include "alidade/geometry/fundamental.h"
#include "alidade/geometry/homography.h"
#include "alidade/geometry/smallest_eigenvector.h"
#include "problems/two_view_problem.h"

namespace alidade::two_view_models_test {
namespace {

std::vector<cv::Point2d> ToCv(const std::vector<Eigen::Vector2d>& points) {
  std::vector<cv::Point2d> result;
  for (const Eigen::Vector2d& p : points) result.emplace_back(p.x(), p.y());
  return result;
}

Eigen::Matrix3d FromCv(const cv::Mat& m) {
  Eigen::Matrix3d result;
  for (int i = 0; i < 9; ++i) result(i / 3, i % 3) = m.at<double>(i / 3, i % 3);
  return result;
}

// Difference of matrices that are defined up to scale and sign.
double Difference(Eigen::Matrix3d x, Eigen::Matrix3d y) {
  x.normalize();
  y.normalize();
  return std::min((x - y).norm(), (x + y).norm());
}

Eigen::Matrix3d Calibration(const Camera& camera) {
  Eigen::Matrix3d K;
  K << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  return K;
}

TEST(SmallestEigenvector, AgreesWithAFullDecomposition) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    Eigen::Matrix<double, 9, 9> a;
    for (int i = 0; i < 81; ++i) a(i / 9, i % 9) = random.Gaussian();
    if (trial % 2) a.row(8).setZero();  // singular, as for an exact solution
    const Eigen::Matrix<double, 9, 9> m = a.transpose() * a;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> oracle(m);
    if (oracle.eigenvalues()[1] < 4 * oracle.eigenvalues()[0]) continue;
    EXPECT_NEAR(std::abs(SmallestEigenvector<9>(m).dot(oracle.eigenvectors().col(0))), 1, 1e-9);
  }
}

TEST(EstimateFundamental, AgreesWithOpenCvOnNoisyPoints) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    const TwoViewProblem problem =
        MakeTwoViewProblem({.matches = 100, .outliers = 0, .noise_px = 0.5, .seed = seed});
    const Eigen::Matrix3d F = EstimateFundamental(problem.a, problem.b);
    const cv::Mat oracle = cv::findFundamentalMat(ToCv(problem.a), ToCv(problem.b), cv::FM_8POINT);
    EXPECT_LT(Difference(F, FromCv(oracle)), 1e-4);  // OpenCV takes points in single precision
    EXPECT_NEAR(F.determinant(), 0, 1e-12);
  }
}

TEST(EstimateFundamental, IsExactForEightExactPoints) {
  for (uint64_t seed = 1; seed <= 50; ++seed) {
    const TwoViewProblem problem =
        MakeTwoViewProblem({.matches = 8, .outliers = 0, .noise_px = 0, .seed = seed});
    const Eigen::Matrix3d K_inverse = Calibration(problem.camera).inverse();
    const Eigen::Matrix3d truth =
        K_inverse.transpose() * EssentialFromMotion(problem.T_b_a) * K_inverse;
    EXPECT_LT(Difference(EstimateFundamental(problem.a, problem.b), truth), 1e-4) << seed;
  }
}

TEST(EstimateHomography, AgreesWithOpenCvAndIsExactOnAPlane) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    const TwoViewProblem exact = MakeTwoViewProblem(
        {.kind = SceneKind::kPlanar, .matches = 8, .outliers = 0, .noise_px = 0, .seed = seed});
    const Eigen::Matrix3d H = EstimateHomography(exact.a, exact.b);
    for (size_t i = 0; i < exact.a.size(); ++i) {
      EXPECT_LT(((H * exact.a[i].homogeneous()).hnormalized() - exact.b[i]).norm(), 1e-6);
    }
    const cv::Mat oracle = cv::findHomography(ToCv(exact.a), ToCv(exact.b), 0);
    EXPECT_LT(Difference(H, FromCv(oracle)), 1e-6);
  }
}

TEST(MotionsFromEssential, AreOpenCvs) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    const Se3 truth = MakeTwoViewProblem({.matches = 1, .seed = seed}).T_b_a;
    const Eigen::Matrix3d E = EssentialFromMotion(truth);
    cv::Mat R1, R2, t, essential(3, 3, CV_64F);
    for (int i = 0; i < 9; ++i) essential.at<double>(i / 3, i % 3) = E(i / 3, i % 3);
    cv::decomposeEssentialMat(essential, R1, R2, t);
    const std::vector<Se3> motions = MotionsFromEssential(E);
    ASSERT_EQ(motions.size(), 4u);
    int truths = 0;
    for (const Se3& motion : motions) {
      EXPECT_LT(Difference(EssentialFromMotion(motion), E), 1e-9);
      EXPECT_LT(std::min((motion.R - FromCv(R1)).norm(), (motion.R - FromCv(R2)).norm()), 1e-9);
      truths +=
          (motion.R - truth.R).norm() < 1e-9 && (motion.t - truth.t.normalized()).norm() < 1e-9;
    }
    EXPECT_EQ(truths, 1);
  }
}

TEST(MotionsFromHomography, MakeTheHomographyAndIncludeTheTruthAndOpenCvs) {
  for (uint64_t seed = 1; seed <= 50; ++seed) {
    Random random(seed);
    const Se3 truth = MakeTwoViewProblem({.matches = 1, .seed = seed}).T_b_a;
    const Eigen::Vector3d n(random.Uniform(-0.2, 0.2), random.Uniform(-0.2, 0.2), 0.3);
    const Eigen::Matrix3d H = truth.R + truth.t * n.transpose();
    for (const double scale : {1.0, -3.0}) {  // a homography is defined up to scale and sign
      const std::vector<Se3> motions = MotionsFromHomography(scale * H);
      ASSERT_EQ(motions.size(), 8u);
      double nearest = 10;
      for (const Se3& motion : motions) {
        EXPECT_NEAR(motion.R.determinant(), 1, 1e-9);
        EXPECT_NEAR(motion.t.norm(), 1, 1e-12);
        // H = s R + t n' for some s and n: the part without s R, projected perpendicular to t, is
        // zero.
        const Eigen::Matrix3d across =
            Eigen::Matrix3d::Identity() - motion.t * motion.t.transpose();
        const Eigen::Matrix3d x = across * H, y = across * motion.R;
        const double s = (x.array() * y.array()).sum() / y.squaredNorm();
        EXPECT_LT((x - s * y).norm(), 1e-6);
        nearest = std::min(nearest,
                           (motion.R - truth.R).norm() + (motion.t - truth.t.normalized()).norm());
      }
      EXPECT_LT(nearest, 1e-6) << seed;
      cv::Mat matrix(3, 3, CV_64F);
      for (int i = 0; i < 9; ++i) matrix.at<double>(i / 3, i % 3) = H(i / 3, i % 3);
      std::vector<cv::Mat> Rs, ts, ns;
      cv::decomposeHomographyMat(matrix, cv::Matx33d::eye(), Rs, ts, ns);
      for (size_t k = 0; k < Rs.size(); ++k) {
        const Eigen::Vector3d t(ts[k].at<double>(0), ts[k].at<double>(1), ts[k].at<double>(2));
        double closest = 10;
        for (const Se3& motion : motions) {
          closest = std::min(
              closest, (motion.R - FromCv(Rs[k])).norm() + (motion.t - t.normalized()).norm());
        }
        EXPECT_LT(closest, 1e-4) << seed;
      }
    }
  }
}

TEST(MotionsFromHomography, HasNoneForARotation) {
  EXPECT_TRUE(MotionsFromHomography(ExpSo3({0.1, 0.2, 0.3})).empty());
  EXPECT_TRUE(MotionsFromHomography(Eigen::Matrix3d::Constant(std::nan(""))).empty());
}

}  // namespace
}  // namespace alidade::two_view_models_test
