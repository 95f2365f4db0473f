#include "alidade/geometry/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <string>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/random.h"

namespace alidade::camera_test {
namespace {

Camera Make(int width, int height, double fx, double fy, double cx, double cy,
            std::array<double, 5> distortion) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = fx;
  camera.fy = fy;
  camera.cx = cx;
  camera.cy = cy;
  camera.distortion = distortion;
  return camera;
}

// Published calibrations of TUM RGB-D (freiburg1 and 2) and EuRoC, and one with little distortion.
std::vector<Camera> RealCameras() {
  return {Make(640, 480, 517.3, 516.5, 318.6, 255.3, {0.2624, -0.9531, -0.0054, 0.0026, 1.1633}),
          Make(640, 480, 520.9, 521.0, 325.1, 249.7, {0.2312, -0.7849, -0.0033, -0.0001, 0.9172}),
          Make(752, 480, 458.654, 457.296, 367.215, 248.375,
               {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0}),
          Make(1280, 720, 900, 905, 640, 360, {0.01, 0, 0, 0, 0})};
}

TEST(Camera, DistortsAsOpenCv) {
  for (const Camera& camera : RealCameras()) {
    for (int v = 0; v < camera.height; v += 40) {
      for (int u = 0; u < camera.width; u += 40) {
        const Eigen::Vector3d ray = camera.Unproject({u, v});
        const std::vector<cv::Point3d> points = {{ray.x(), ray.y(), 1}};
        const cv::Matx33d K(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
        const std::vector<double> coefficients(camera.distortion.begin(), camera.distortion.end());
        std::vector<cv::Point2d> pixels;
        cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), K, coefficients, pixels);
        const Eigen::Vector2d ours = camera.Distort({u, v});
        EXPECT_NEAR(ours.x(), pixels[0].x, 1e-8);
        EXPECT_NEAR(ours.y(), pixels[0].y, 1e-8);
      }
    }
  }
}

TEST(Camera, UndistortUndoesDistortOverTheWholeImage) {
  for (const Camera& camera : RealCameras()) {
    for (int v = 0; v < camera.height; v += 10) {
      for (int u = 0; u < camera.width; u += 10) {
        const Eigen::Vector2d taken(u, v);
        EXPECT_LT((camera.Distort(camera.Undistort(taken)) - taken).norm(), 1e-6) << u << " " << v;
      }
    }
    const Eigen::Vector2d centre(camera.cx, camera.cy);
    EXPECT_LT((camera.Undistort(centre) - centre).norm(), 1e-9);
  }
}

TEST(Camera, ProjectAndUnprojectAreInverse) {
  const Camera camera = RealCameras()[0];
  const Eigen::Vector2d pixel(123.4, 321);
  EXPECT_LT((camera.Project(camera.Unproject(pixel, 7)) - pixel).norm(), 1e-12);
  EXPECT_DOUBLE_EQ(camera.Unproject(pixel, 7).z(), 7);
}

TEST(Camera, ScalesWithItsImage) {
  const Camera camera = RealCameras()[3];
  const Camera half = camera.ScaledToWidth(640);
  EXPECT_EQ(half.height, 360);
  // A pixel of the small image covers 2 x 2 pixels of the large one; its center is between theirs.
  const Eigen::Vector3d p(0.3, -0.2, 1.5);
  const Eigen::Vector2d large = camera.Project(p), small = half.Project(p);
  EXPECT_NEAR(small.x(), (large.x() - 0.5) / 2, 1e-9);
  EXPECT_NEAR(small.y(), (large.y() - 0.5) / 2, 1e-9);
  EXPECT_EQ(half.distortion, camera.distortion);
  EXPECT_THROW(camera.ScaledToWidth(0), Error);
}

TEST(Camera, FromFieldOfViewSeesThatAngle) {
  const Camera camera = Camera::FromFieldOfView(640, 480, 66);
  const Eigen::Vector3d left = camera.Unproject({-0.5, camera.cy}),
                        right = camera.Unproject({639.5, camera.cy});
  EXPECT_NEAR((std::atan(right.x()) - std::atan(left.x())) * 180 / 3.14159265358979, 66, 1e-9);
  camera.Check();
  EXPECT_THROW(Camera::FromFieldOfView(640, 480, 0), Error);
  EXPECT_THROW(Camera::FromFieldOfView(640, 480, 180), Error);
  EXPECT_THROW(Camera::FromFieldOfView(640, 480, std::nan("")), Error);
}

TEST(Camera, CheckNamesTheFieldThatCannotBe) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto message = [](auto change) -> std::string {
    Camera camera = RealCameras()[0];
    change(camera);
    try {
      camera.Check();
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message([](Camera&) {}), "");
  EXPECT_NE(message([](Camera& c) { c.width = 0; }).find("width"), std::string::npos);
  EXPECT_NE(message([](Camera& c) { c.fx = -500; }).find("fx"), std::string::npos);
  EXPECT_NE(message([&](Camera& c) { c.fy = nan; }).find("fy"), std::string::npos);
  EXPECT_NE(message([&](Camera& c) { c.cy = nan; }).find("cy"), std::string::npos);
  EXPECT_NE(message([&](Camera& c) { c.distortion[2] = nan; }).find("distortion"),
            std::string::npos);
  EXPECT_NE(message([](Camera& c) { c.fps = 0; }).find("fps"), std::string::npos);
  EXPECT_NE(message([](Camera& c) { c.baseline = -1; }).find("baseline"), std::string::npos);
  EXPECT_NE(message([](Camera& c) { c.depth_factor = -1; }).find("depth_factor"),
            std::string::npos);
  // Finite, but their squares are not.
  for (auto change :
       {+[](Camera& c) { c.fx = 1e200; }, +[](Camera& c) { c.fy = 1e-200; },
        +[](Camera& c) { c.cx = -1e200; }, +[](Camera& c) { c.distortion[4] = 1e200; },
        +[](Camera& c) { c.fps = 1e-200; }, +[](Camera& c) { c.baseline = 1e200; },
        +[](Camera& c) { c.depth_factor = 1e-200; }})
    EXPECT_NE(message(change).find("number that cannot be"), std::string::npos);
}

// Distortion that is not invertible within the image: Newton's method does not converge.
TEST(Camera, UndistortedPixelsAreSomewhereWhateverTheLens) {
  Random random(3);
  for (int round = 0; round < 2000; ++round) {
    Camera camera = RealCameras()[0];
    camera.fx = std::pow(10, random.Uniform(-9, 3));
    camera.fy = std::pow(10, random.Uniform(-9, 3));
    for (double& k : camera.distortion)
      k = (random.Below(2) == 0 ? -1 : 1) * std::pow(10, random.Uniform(-9, 9));
    camera.Check();
    const Eigen::Vector2d ideal =
        camera.Undistort({random.Uniform(0, 640), random.Uniform(0, 480)});
    EXPECT_TRUE(ideal.allFinite() && ideal.cwiseAbs().maxCoeff() <= 1e9) << ideal.transpose();
  }
}

}  // namespace
}  // namespace alidade::camera_test
