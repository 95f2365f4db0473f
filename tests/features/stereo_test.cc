#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "alidade/base/error.h"
#include "alidade/base/parallel.h"
#include "alidade/features/extractor.h"
#include "support/texture.h"

namespace alidade::stereo_test {
namespace {

// A surface with varying disparity, rendered for both cameras of a rectified pair.
struct StereoPair {
  Camera camera = Camera::FromFieldOfView(640, 480, 70);
  cv::Mat left, right;
  // Disparity at a pixel of the left image; it defines the surface.
  static double Disparity(double x, double y) {
    return 20 + 8 * std::sin(x / 120) + 6 * std::cos(y / 90) + 0.01 * x;
  }
};

StereoPair MakeStereoPair(double noise, double right_gain = 1, double right_offset = 0) {
  StereoPair pair;
  pair.camera.baseline = 0.12;
  pair.left = MakeTexture(640, 480, 21);
  // right(u) = left(x) where x - disparity(x) = u, solved by fixed-point iteration (the disparity
  // varies slowly).
  cv::Mat map_x(480, 640, CV_32FC1), map_y(480, 640, CV_32FC1);
  for (int y = 0; y < 480; ++y) {
    for (int u = 0; u < 640; ++u) {
      double x = u;
      for (int i = 0; i < 12; ++i) x = u + StereoPair::Disparity(x, y);
      map_x.at<float>(y, u) = static_cast<float>(x);
      map_y.at<float>(y, u) = static_cast<float>(y);
    }
  }
  cv::remap(pair.left, pair.right, map_x, map_y, cv::INTER_CUBIC, cv::BORDER_REFLECT_101);
  pair.right.convertTo(pair.right, CV_8U, right_gain, right_offset);
  AddNoise(pair.left, noise, 1);
  AddNoise(pair.right, noise, 2);
  return pair;
}

// Rendered once, because rendering is slow.
const StereoPair& Plain() {
  static const StereoPair kPair = MakeStereoPair(2);
  return kPair;
}

Frame Extract(const cv::Mat& image, const Camera& camera) {
  return Extractor().Extract(image, camera, 0, 0);
}

struct Errors {
  std::vector<double> pixels;  // of level 0, sorted
  int keypoints = 0;
  double Share(double share) const { return pixels[static_cast<size_t>(share * pixels.size())]; }
};

Errors Match(const StereoPair& pair) {
  Frame left = Extract(pair.left, pair.camera);
  MatchStereo(Extract(pair.right, pair.camera), pair.camera, left);
  Errors errors;
  for (const Keypoint& k : left.keypoints) {
    if (k.x < 60) continue;  // outside of the right image
    ++errors.keypoints;
    if (!k.has_depth()) continue;
    const double disparity = pair.camera.bf() / k.depth;
    EXPECT_NEAR(k.x - k.right_x, disparity, 1e-3);
    errors.pixels.push_back(std::abs(disparity - StereoPair::Disparity(k.x, k.y)));
  }
  std::sort(errors.pixels.begin(), errors.pixels.end());
  return errors;
}

TEST(MatchStereo, FindsDisparityToATenthOfAPixel) {
  const Errors errors = Match(Plain());
  ASSERT_GT(errors.pixels.size(), 0.6 * errors.keypoints);
  EXPECT_LT(errors.Share(0.5), 0.1);
  EXPECT_LT(errors.Share(0.95), 0.6);
}

TEST(MatchStereo, BearsADifferenceInExposure) {
  const Errors errors = Match(MakeStereoPair(2, 0.9, 12));
  ASSERT_GT(errors.pixels.size(), 0.5 * errors.keypoints);
  EXPECT_LT(errors.Share(0.5), 0.15);
}

TEST(MatchStereo, FindsNothingInUnrelatedImages) {
  StereoPair pair = Plain();
  pair.right = MakeTexture(640, 480, 99);
  EXPECT_LT(Match(pair).pixels.size(), 60u);
}

TEST(MatchStereo, TakesNeitherPointsAtInfinityNorNearerThanTheBaseline) {
  StereoPair pair = Plain();
  pair.right = pair.left.clone();
  EXPECT_LT(Match(pair).pixels.size(), 0.2 * 1000);
  Frame left = Extract(pair.left, pair.camera);
  MatchStereo(Extract(pair.right, pair.camera), pair.camera, left);
  for (const Keypoint& k : left.keypoints) {
    if (!k.has_depth()) continue;
    EXPECT_GE(k.depth, pair.camera.baseline);
    EXPECT_GE(k.x - k.right_x, 0.09);
  }
}

TEST(MatchStereo, GivesTheSameWithOneAndWithManyThreads) {
  const StereoPair& pair = Plain();
  const Frame right = Extract(pair.right, pair.camera);
  Frame alone = Extract(pair.left, pair.camera), together = alone;
  SetThreadCount(1);
  MatchStereo(right, pair.camera, alone);
  SetThreadCount(3);
  MatchStereo(right, pair.camera, together);
  SetThreadCount(0);
  for (size_t i = 0; i < alone.keypoints.size(); ++i) {
    EXPECT_EQ(alone.keypoints[i].depth, together.keypoints[i].depth);
  }
}

TEST(MatchStereo, NeedsBothPyramidsAndEqualSizes) {
  const StereoPair& pair = Plain();
  Frame left = Extract(pair.left, pair.camera), right = left;
  right.pyramid.clear();
  EXPECT_THROW(MatchStereo(right, pair.camera, left), Error);
  const cv::Mat small = MakeTexture(320, 240, 1);
  const Frame other = Extract(small, Camera::FromFieldOfView(320, 240, 60));
  EXPECT_THROW(MatchStereo(other, pair.camera, left), Error);
}

}  // namespace
}  // namespace alidade::stereo_test
