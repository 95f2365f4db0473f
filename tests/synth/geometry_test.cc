// Consistency of depth, poses and images.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <vector>

#include "alidade/synth/recording.h"

namespace alidade::geometry_test {
namespace {

SynthSettings Small(const std::string& scene) {
  SynthSettings settings;
  settings.scene = scene;
  settings.width = 320;
  settings.height = 240;
  return settings;
}

float Bilinear(const cv::Mat& image, const Eigen::Vector2d& pixel) {
  const int x = static_cast<int>(std::floor(pixel.x())),
            y = static_cast<int>(std::floor(pixel.y()));
  const float fx = static_cast<float>(pixel.x() - x), fy = static_cast<float>(pixel.y() - y);
  const float top = image.at<float>(y, x) * (1 - fx) + image.at<float>(y, x + 1) * fx;
  const float bottom = image.at<float>(y + 1, x) * (1 - fx) + image.at<float>(y + 1, x + 1) * fx;
  return top * (1 - fy) + bottom * fy;
}

struct Agreement {
  int tested = 0;           // pixels of the first view visible in the second
  double median_grey = 0;   // difference of gray levels
  double median_depth = 0;  // relative difference of depth
  // Gray-level difference with the second pose wrong by one degree, divided by median_grey.
  double gain = 0;
};

double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

// Transfers textured pixels of the first view to the second by depth and poses.
Agreement Reproject(const RawCamera& camera, const RenderedFrame& a, const Se3& T_world_a,
                    const RenderedFrame& b, const Se3& T_world_b) {
  Agreement result;
  std::vector<double> grey, wrong_grey, depth;
  const Se3 T_b_a = T_world_b.Inverse() * T_world_a;
  const Se3 wrong = Se3{ExpSo3({0.017, 0, 0}), Eigen::Vector3d::Zero()} * T_b_a;
  const auto inside = [&](const Eigen::Vector2d& p) {
    return p.x() > 1 && p.y() > 1 && p.x() < camera.width - 2 && p.y() < camera.height - 2;
  };
  for (int y = 2; y < camera.height - 2; y += 2) {
    for (int x = 2; x < camera.width - 2; x += 2) {
      const float step = std::abs(a.clean.at<float>(y, x + 1) - a.clean.at<float>(y, x - 1));
      const float z = a.depth_exact.at<float>(y, x);
      if (step < 10 || !(z > 0)) continue;  // uniform regions agree with anything
      const Eigen::Vector3d ray = camera.Direction({x, y}), p_a = ray * (z / ray.z());
      const Eigen::Vector3d p_b = T_b_a * p_a, p_wrong = wrong * p_a;
      if (p_b.z() < 0.1 || p_wrong.z() < 0.1) continue;
      const Eigen::Vector2d pixel = camera.Project(p_b), pixel_wrong = camera.Project(p_wrong);
      if (!inside(pixel) || !inside(pixel_wrong)) continue;
      const double there = Bilinear(b.depth_exact, pixel);
      if (std::abs(there - p_b.z()) > 0.03 * there) continue;  // occluded, or at a depth edge
      const double here = a.clean.at<float>(y, x);
      grey.push_back(std::abs(Bilinear(b.clean, pixel) - here));
      wrong_grey.push_back(std::abs(Bilinear(b.clean, pixel_wrong) - here));
      depth.push_back(std::abs(there - p_b.z()) / there);
    }
  }
  result.tested = static_cast<int>(grey.size());
  if (grey.empty()) return result;
  result.median_grey = Median(grey);
  result.median_depth = Median(depth);
  result.gain = Median(wrong_grey) / result.median_grey;
  return result;
}

void ExpectAgreement(const SynthSettings& settings, int first, int second) {
  const SynthRecording recording(settings);
  const Agreement found =
      Reproject(recording.lens(), recording.Render(first), recording.Pose(first),
                recording.Render(second), recording.Pose(second));
  EXPECT_GT(found.tested, settings.scene == "road" ? 150 : 400) << settings.scene;  // fields
  EXPECT_LT(found.median_grey, 5) << settings.scene;
  EXPECT_LT(found.median_depth, 1e-3) << settings.scene;
  EXPECT_GT(found.gain, 2) << settings.scene;  // otherwise the test could not fail
}

TEST(SynthGeometry, DepthAndPosesCarryTextureFromOneViewToAnother) {
  for (const std::string& scene : SceneNames()) {
    SynthSettings settings = Small(scene);
    ExpectAgreement(settings, 40, 46);
  }
}

TEST(SynthGeometry, LensDistortionIsTheCameraModels) {
  SynthSettings settings = Small("room");
  settings.distortion = true;
  ExpectAgreement(settings, 100, 108);
  const Camera camera = SynthRecording(settings).camera();
  ASSERT_TRUE(camera.HasDistortion());
  // The distortion is strong enough to matter: the corner moves by several pixels.
  EXPECT_GT((camera.Undistort({0, 0}) - Eigen::Vector2d(0, 0)).norm(), 5);
}

TEST(SynthGeometry, StrongRadialDistortionAndAFisheyeAreTheCameraModelsToo) {
  SynthSettings settings = Small("room");
  settings.k1 = -0.24;
  ExpectAgreement(settings, 100, 108);
  settings.k1 = 0;
  settings.fisheye = true;
  settings.fov = 120;
  ExpectAgreement(settings, 100, 108);
  // 120 degrees from the left to the right edge, with the same number of pixels per degree.
  const RawCamera lens = SynthRecording(settings).lens();
  const auto angle = [&](double x) {
    const Eigen::Vector3d ray = lens.Direction({x, lens.cy});
    return std::atan2(ray.x(), ray.z()) * 180 / std::numbers::pi;
  };
  EXPECT_NEAR(angle(319.5) - angle(-0.5), 120, 1e-9);
  EXPECT_NEAR(angle(239.5), 30, 1e-9);
}

TEST(SynthGeometry, TheFieldOfViewIsTheHorizontalOneAskedFor) {
  SynthSettings settings = Small("room");
  settings.width = 180;
  settings.height = 320;
  settings.fov = 40;
  ExpectAgreement(settings, 40, 46);
  const Camera camera = SynthRecording(settings).camera();
  EXPECT_NEAR(std::atan(90 / camera.fx) * 360 / std::numbers::pi, 40, 1e-9);
  EXPECT_EQ(camera.fx, camera.fy);
}

TEST(SynthGeometry, DisparityOfTheSecondCameraIsBaselineTimesFocalLengthOverDepth) {
  SynthSettings settings = Small("room");
  settings.stereo = true;
  settings.noise = 0;
  const SynthRecording recording(settings);
  const Camera& camera = recording.camera();
  ASSERT_GT(camera.baseline, 0.05);
  const RenderedFrame frame = recording.Render(150);
  ASSERT_EQ(frame.right.size(), frame.image.size());
  cv::Mat right;
  frame.right.convertTo(right, CV_32F);
  std::vector<double> true_error, wrong_error;
  for (int y = 4; y < camera.height - 4; y += 2) {
    for (int x = 4; x < camera.width - 4; x += 2) {
      const float step =
          std::abs(frame.clean.at<float>(y, x + 1) - frame.clean.at<float>(y, x - 1));
      const double u = x - camera.fx * camera.baseline / frame.depth_exact.at<float>(y, x);
      if (step < 12 || u < 3) continue;
      const double here = frame.clean.at<float>(y, x);
      true_error.push_back(std::abs(Bilinear(right, {u, y + 0.0}) - here));
      wrong_error.push_back(std::abs(Bilinear(right, {u - 1.5, y + 0.0}) - here));
    }
  }
  ASSERT_GT(true_error.size(), 500u);
  EXPECT_LT(Median(true_error), 5);
  EXPECT_GT(Median(wrong_error), 2 * Median(true_error));
}

TEST(SynthGeometry, RowsOfARollingShutterAreSeenFromThePosesOfTheirTimes) {
  SynthSettings settings = Small("room");
  settings.fps = 1000;  // poses and images at every millisecond
  const SynthRecording global(settings);
  settings.rolling_shutter = 16;
  const RenderedFrame moving = SynthRecording(settings).Render(4000);
  // Row r is read ((r + 0.5) / 240 - 0.5) × 16 ms after the frame's time.
  const auto row_difference = [&](int milliseconds, int row) {
    const RenderedFrame still = global.Render(4000 + milliseconds);
    return cv::norm(still.clean.row(row), moving.clean.row(row), cv::NORM_L1) / still.clean.cols;
  };
  const double first = row_difference(-8, 0), last = row_difference(8, 239),
               middle = row_difference(0, 120);
  EXPECT_LT(first, 1);
  EXPECT_LT(last, 1);
  EXPECT_LT(middle, 1);
  EXPECT_GT(row_difference(8, 0), 2.5 * first);
  EXPECT_GT(row_difference(-8, 239), 2.5 * last);
}

TEST(SynthGeometry, ARollingShutterTakesAsLongAsAsked) {
  SynthSettings settings = Small("desk");
  settings.path = "turn";
  settings.fps = 1000;
  const SynthRecording global(settings);
  settings.rolling_shutter = 40;
  const RenderedFrame moving = SynthRecording(settings).Render(3000);
  const auto row_difference = [&](int milliseconds, int row) {
    const RenderedFrame still = global.Render(3000 + milliseconds);
    return cv::norm(still.clean.row(row), moving.clean.row(row), cv::NORM_L1) / still.clean.cols;
  };
  EXPECT_LT(row_difference(-20, 0), 1);
  EXPECT_LT(row_difference(20, 239), 1);
  EXPECT_LT(row_difference(10, 180), 1);
  EXPECT_GT(row_difference(8, 239), 2);
}

}  // namespace
}  // namespace alidade::geometry_test
