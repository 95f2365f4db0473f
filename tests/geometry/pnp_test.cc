#include "alidade/geometry/pnp.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <vector>

#include "alidade/base/error.h"
#include "problems/pnp_problem.h"

namespace alidade::pnp_test {
namespace {

struct ThreePoints {
  Eigen::Vector3d p_world[3], rays[3];
};

ThreePoints FirstThree(const PnpProblem& problem) {
  ThreePoints three;
  for (int i = 0; i < 3; ++i) {
    three.p_world[i] = problem.p_world[i];
    three.rays[i] = problem.camera.Unproject(problem.pixels[i]).normalized();
  }
  return three;
}

double Distance(const Se3& a, const Se3& b) { return (a.R - b.R).norm() + (a.t - b.t).norm(); }

double NearestTo(const Se3& truth, const std::vector<Se3>& poses) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Se3& pose : poses) nearest = std::min(nearest, Distance(pose, truth));
  return nearest;
}

TEST(SolveP3p, HasTheTruthAmongItsPoses) {
  int found = 0;
  for (uint64_t seed = 1; seed <= 2000; ++seed) {
    const PnpProblem problem = MakePnpProblem({.matches = 3, .seed = seed});
    const ThreePoints three = FirstThree(problem);
    const std::vector<Se3> poses = SolveP3p(three.p_world, three.rays);
    EXPECT_LE(poses.size(), 4u);
    found += NearestTo(problem.T_camera_world, poses) < 1e-5;
    for (const Se3& pose : poses) {
      EXPECT_NEAR((pose.R.transpose() * pose.R - Eigen::Matrix3d::Identity()).norm(), 0, 1e-9);
      EXPECT_NEAR(pose.R.determinant(), 1, 1e-9);
      for (int i = 0; i < 3; ++i) {
        EXPECT_LT(((pose * three.p_world[i]).normalized() - three.rays[i]).norm(), 1e-5) << seed;
      }
    }
  }
  EXPECT_GE(found, 1998);  // two solutions may merge, where no solver is exact
}

TEST(SolveP3p, CopesWithSymmetry) {
  const double half = std::sqrt(0.75);
  const Eigen::Vector3d triangles[3][3] = {
      {{1, 0, 0}, {-0.5, half, 0}, {-0.5, -half, 0}},  // equilateral
      {{-1, 0, 0}, {1, 0, 0}, {0, 1, 0}},              // isosceles
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};              // right angle
  for (const auto& triangle : triangles) {
    for (const double depth : {2.0, 5.0}) {
      Se3 truth;
      truth.t = {0, 0, depth};
      Eigen::Vector3d rays[3];
      for (int i = 0; i < 3; ++i) rays[i] = (truth * triangle[i]).normalized();
      EXPECT_LT(NearestTo(truth, SolveP3p(triangle, rays)), 1e-5);
    }
  }
}

TEST(SolveP3p, FindsWhatOpenCvFinds) {
  int more = 0, fewer = 0;
  for (uint64_t seed = 1; seed <= 500; ++seed) {
    const PnpProblem problem = MakePnpProblem({.matches = 3, .noise_px = 30, .seed = seed});
    const ThreePoints three = FirstThree(problem);
    const std::vector<Se3> poses = SolveP3p(three.p_world, three.rays);
    std::vector<cv::Point3d> points;
    std::vector<cv::Point2d> pixels;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d& p = three.p_world[i];
      points.emplace_back(p.x(), p.y(), p.z());
      pixels.emplace_back(problem.pixels[i].x(), problem.pixels[i].y());
    }
    const Camera& c = problem.camera;
    const cv::Matx33d K(c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
    std::vector<cv::Mat> rotations, translations;
    cv::solveP3P(points, pixels, K, cv::noArray(), rotations, translations, cv::SOLVEPNP_AP3P);
    int theirs = 0, common = 0;
    for (size_t k = 0; k < rotations.size(); ++k) {
      Se3 pose;
      pose.R = ExpSo3(
          {rotations[k].at<double>(0), rotations[k].at<double>(1), rotations[k].at<double>(2)});
      pose.t = {translations[k].at<double>(0), translations[k].at<double>(1),
                translations[k].at<double>(2)};
      bool valid = true;  // some of OpenCV's solutions do not satisfy the constraints
      for (int i = 0; i < 3; ++i) {
        valid = valid && ((pose * three.p_world[i]).normalized() - three.rays[i]).norm() < 1e-4;
      }
      theirs += valid;
      common += valid && NearestTo(pose, poses) < 1e-2;
    }
    more += static_cast<int>(poses.size()) > theirs;
    fewer += common < theirs;
  }
  EXPECT_LE(fewer, 2);
  EXPECT_LE(more, 25);
}

TEST(SolveP3p, GivesNothingForPointsOnALineOrNotNumbers) {
  const Eigen::Vector3d rays[3] = {Eigen::Vector3d(0, 0, 1),
                                   Eigen::Vector3d(0.1, 0, 1).normalized(),
                                   Eigen::Vector3d(0.2, 0, 1).normalized()};
  const Eigen::Vector3d line[3] = {{0, 0, 2}, {0.2, 0, 2}, {0.4, 0, 2}};
  EXPECT_TRUE(SolveP3p(line, rays).empty());
  const Eigen::Vector3d same[3] = {{0, 0, 2}, {0, 0, 2}, {0.4, 0, 2}};
  EXPECT_TRUE(SolveP3p(same, rays).empty());
  const Eigen::Vector3d broken[3] = {{0, 0, std::nan("")}, {0.2, 0, 2}, {0.4, 0.1, 2}};
  EXPECT_TRUE(SolveP3p(broken, rays).empty());
}

TEST(SolvePnpRansac, FindsThePoseAmongOutliers) {
  for (const bool planar : {false, true}) {
    for (uint64_t seed = 1; seed <= 50; ++seed) {
      const PnpProblem problem =
          MakePnpProblem({.outliers = 0.5, .noise_px = 0.7, .planar = planar, .seed = seed});
      const PnpResult result = SolvePnpRansac(problem.camera, problem.p_world, problem.pixels);
      ASSERT_TRUE(result.success) << seed;
      EXPECT_EQ(std::count(result.inlier.begin(), result.inlier.end(), true), result.inliers);
      EXPECT_LT(RotationAngle(result.T_camera_world, problem.T_camera_world), 0.03) << seed;
      EXPECT_LT((result.T_camera_world.t - problem.T_camera_world.t).norm(), 0.15) << seed;
      int kept = 0, inliers = 0, wrong = 0;
      for (size_t i = 0; i < problem.outlier.size(); ++i) {
        inliers += !problem.outlier[i];
        kept += result.inlier[i] && !problem.outlier[i];
        wrong += result.inlier[i] && problem.outlier[i];
      }
      EXPECT_GT(kept, 0.7 * inliers);
      EXPECT_LE(wrong, 3);
    }
  }
}

TEST(SolvePnpRansac, IsAsCloseAsOpenCvsRansacBeforeRefinement) {
  double ours = 0, theirs = 0;
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    const PnpProblem problem = MakePnpProblem({.outliers = 0.3, .noise_px = 1, .seed = seed});
    const PnpResult result = SolvePnpRansac(problem.camera, problem.p_world, problem.pixels);
    std::vector<cv::Point3d> points;
    std::vector<cv::Point2d> pixels;
    for (size_t i = 0; i < problem.pixels.size(); ++i) {
      const Eigen::Vector3d& p = problem.p_world[i];
      points.emplace_back(p.x(), p.y(), p.z());
      pixels.emplace_back(problem.pixels[i].x(), problem.pixels[i].y());
    }
    const Camera& c = problem.camera;
    const cv::Matx33d K(c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
    cv::Vec3d w, t;
    std::vector<int> inliers;
    ASSERT_TRUE(cv::solvePnPRansac(points, pixels, K, cv::noArray(), w, t, false, 300, 3.f, 0.999,
                                   inliers, cv::SOLVEPNP_P3P));
    ours += result.inliers;
    theirs += static_cast<double>(inliers.size());
  }
  EXPECT_GT(ours, 0.95 * theirs);
}

// Most matches lie in one corner of the image, as after a rotation during a gap; few others
// constrain the pose. A sample from the corner alone has nearly all matches as inliers.
TEST(SolvePnpRansac, IsNotContentWithTheFirstSampleThatNearlyAllAgreeWith) {
  double worst = 0;  // meters, at about 3 m from the points
  for (uint64_t seed = 1; seed <= 100; ++seed) {
    PnpProblem problem =
        MakePnpProblem({.matches = 2000, .noise_px = 0.7, .planar = true, .seed = seed});
    std::vector<Eigen::Vector3d> p_world;
    std::vector<Eigen::Vector2d> pixels;
    int beside = 0;
    for (size_t i = 0; i < problem.pixels.size(); ++i) {
      const Eigen::Vector2d& pixel = problem.pixels[i];
      const bool corner = pixel.x() < 160 && pixel.y() < 160;
      if (!corner && (pixel.x() > 350 || beside++ >= 8)) continue;
      p_world.push_back(problem.p_world[i]);
      pixels.push_back(pixel);
    }
    const PnpResult result = SolvePnpRansac(problem.camera, p_world, pixels, {}, {.seed = seed});
    ASSERT_TRUE(result.success) << seed;
    const Eigen::Vector3d off =
        result.T_camera_world.Inverse().t - problem.T_camera_world.Inverse().t;
    worst = std::max(worst, off.norm());
  }
  EXPECT_LT(worst, 0.1);
}

TEST(SolvePnpRansac, AllowsCoarseKeypointsTheirError) {
  PnpProblem problem = MakePnpProblem({.matches = 100, .seed = 3});
  std::vector<double> scale(100, 1.0);
  for (int i = 0; i < 100; i += 2) {
    scale[i] = 4;
    problem.pixels[i].x() += 8;  // above max_error of 3 pixels, below 4 × 3 pixels
  }
  const PnpResult with = SolvePnpRansac(problem.camera, problem.p_world, problem.pixels, scale,
                                        {.confidence = 0.999999});
  const PnpResult without =
      SolvePnpRansac(problem.camera, problem.p_world, problem.pixels, {}, {.confidence = 0.999999});
  EXPECT_EQ(with.inliers, 100);
  EXPECT_LT(without.inliers, 80);
}

TEST(SolvePnpRansac, SaysNoWhenThereIsNothingToFind) {
  const PnpProblem noise = MakePnpProblem({.matches = 60, .outliers = 1, .seed = 4});
  EXPECT_FALSE(SolvePnpRansac(noise.camera, noise.p_world, noise.pixels).success);
  EXPECT_FALSE(SolvePnpRansac(noise.camera, {}, {}).success);
  PnpProblem few = MakePnpProblem({.matches = 12, .seed = 4});
  EXPECT_TRUE(SolvePnpRansac(few.camera, few.p_world, few.pixels).success);
  for (int i = 0; i < 3; ++i) few.p_world[i].x() = std::nan("");
  EXPECT_FALSE(SolvePnpRansac(few.camera, few.p_world, few.pixels).success);
  EXPECT_THROW(SolvePnpRansac(few.camera, few.p_world, {}), Error);
}

}  // namespace
}  // namespace alidade::pnp_test
