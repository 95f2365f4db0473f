#include "alidade/surface/stereo_depth.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/dense_views.h"

namespace alidade::stereo_depth_test {
namespace {

TEST(StereoDepth, HasTheErrorItSaysAndNoneWithoutAMatch) {
  const SynthRecording recording(SmallRoom(true));
  const RenderedFrame frame = recording.Render(0);
  const Camera& camera = recording.camera();
  const cv::Mat1f depth = StereoDepth(frame.image, frame.right, camera, 0.4);
  const double bf = camera.fx * camera.baseline;
  std::vector<double> errors;
  int known = 0;
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const float z = depth(y, x);
      if (!(z > 0)) continue;
      EXPECT_LE(bf / z, x + 1e-3);  // its match is inside the right image
      ++known;
      errors.push_back(std::abs(bf / z - bf / frame.depth_exact.at<float>(y, x)));
    }
  }
  EXPECT_GT(known, depth.rows * depth.cols / 2);
  std::nth_element(errors.begin(), errors.begin() + errors.size() * 68 / 100, errors.end());
  EXPECT_LT(errors[errors.size() * 68 / 100], 1.5 * kDisparitySigma);
}

}  // namespace
}  // namespace alidade::stereo_depth_test
