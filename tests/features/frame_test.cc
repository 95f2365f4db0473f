#include "alidade/features/frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "alidade/base/random.h"

namespace alidade::frame_test {
namespace {

std::vector<Keypoint> RandomKeypoints(int count, int width, int height, double outside) {
  Random random(3);
  std::vector<Keypoint> keypoints(count);
  for (Keypoint& k : keypoints) {
    k.x = static_cast<float>(random.Uniform(-outside, width + outside));
    k.y = static_cast<float>(random.Uniform(-outside, height + outside));
  }
  return keypoints;
}

TEST(ScaleOfLevel, IsAPowerOfThePyramidsScale) {
  for (int level = 0; level < kPyramidLevels; ++level) {
    EXPECT_NEAR(ScaleOfLevel(level), std::pow(1.2, level), 1e-12);
  }
}

TEST(KeypointGrid, FindsWhatALookAtAllOfThemFinds) {
  // 400 pixels outside the image, beyond the grid's margin: assigned to the border cells.
  for (double outside : {0.0, 40.0, 400.0}) {
    const std::vector<Keypoint> keypoints = RandomKeypoints(500, 320, 200, outside);
    const KeypointGrid grid(keypoints, 320, 200);
    Random random(4);
    for (int query = 0; query < 300; ++query) {
      const float x = static_cast<float>(random.Uniform(-outside - 30, 350 + outside));
      const float y = static_cast<float>(random.Uniform(-outside - 30, 230 + outside));
      const float radius = static_cast<float>(random.Uniform(0, 60));
      std::vector<int> visited;
      grid.VisitNear(x, y, radius, [&](int i) { visited.push_back(i); });
      const std::set<int> once(visited.begin(), visited.end());
      ASSERT_EQ(once.size(), visited.size()) << "a keypoint was visited twice";
      for (int i = 0; i < static_cast<int>(keypoints.size()); ++i) {
        const bool near =
            std::abs(keypoints[i].x - x) <= radius && std::abs(keypoints[i].y - y) <= radius;
        ASSERT_TRUE(!near || once.count(i)) << "query " << query << " misses keypoint " << i;
      }
    }
  }
}

TEST(KeypointGrid, VisitsFewMoreThanAskedFor) {
  const std::vector<Keypoint> keypoints = RandomKeypoints(1000, 640, 480, 0);
  const KeypointGrid grid(keypoints, 640, 480);
  int visited = 0;
  grid.VisitNear(320, 240, 16, [&](int i) {
    ++visited;
    EXPECT_LE(std::abs(keypoints[i].x - 320), 16 + KeypointGrid::kCell);
    EXPECT_LE(std::abs(keypoints[i].y - 240), 16 + KeypointGrid::kCell);
  });
  EXPECT_GT(visited, 0);
}

TEST(KeypointGrid, HoldsNothingWhenThereIsNothing) {
  int visited = 0;
  KeypointGrid({}, 640, 480).VisitNear(10, 10, 1000, [&](int) { ++visited; });
  KeypointGrid().VisitNear(10, 10, 1000, [&](int) { ++visited; });
  EXPECT_EQ(visited, 0);
}

}  // namespace
}  // namespace alidade::frame_test
