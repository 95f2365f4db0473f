#include "alidade/surface/stereo_depth.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/dense_views.h"

namespace alidade::stereo_depth_test {
namespace {

// Errors over their standard deviations; the smallest that 68 % are below is 1 if all is right.
double Quantile68(std::vector<double> ratios) {
  const auto nth = ratios.begin() + static_cast<ptrdiff_t>(ratios.size() * 68 / 100);
  std::nth_element(ratios.begin(), nth, ratios.end());
  return *nth;
}

TEST(StereoDepth, HasTheErrorItSaysAndNoneWithoutAMatch) {
  const SynthRecording recording(SmallRoom(true));
  const RenderedFrame frame = recording.Render(0);
  const Camera& camera = recording.camera();
  const StereoMatch match = MatchStereo(frame.image, frame.right, camera, 0.4);
  const cv::Mat1f& depth = match.depth;
  const double bf = camera.fx * camera.baseline;
  std::vector<double> errors, sharp, vague;  // those of pixels with and without contrast
  int known = 0;
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const float z = depth(y, x);
      if (!(z > 0)) continue;
      EXPECT_LE(bf / z, x + 1e-3);  // its match is inside the right image
      ++known;
      errors.push_back(std::abs(bf / z - bf / frame.depth_exact.at<float>(y, x)));
      const double sigma = bf * match.inverse_sigmas(y, x);
      (sigma < kDisparitySigma ? sharp : vague).push_back(errors.back() / sigma);
    }
  }
  EXPECT_GT(known, depth.rows * depth.cols / 2);
  EXPECT_LT(Quantile68(errors), 1.5 * kDisparitySigma);
  for (const std::vector<double>& ratios : {sharp, vague}) {
    EXPECT_GT(ratios.size(), errors.size() / 10);
    EXPECT_GT(Quantile68(ratios), 0.6);
    EXPECT_LT(Quantile68(ratios), 1.5);
  }
}

}  // namespace
}  // namespace alidade::stereo_depth_test
