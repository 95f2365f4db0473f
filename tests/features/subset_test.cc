// Copy of a frame with a subset of its keypoints.
#include "alidade/features/subset.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "alidade/base/random.h"

namespace alidade::subset_test {
namespace {

class SubsetTest : public testing::Test {
 protected:
  SubsetTest() {
    camera_.width = 320;
    camera_.height = 240;
    Random random(3);
    frame_.time = 4.5;
    frame_.number = 17;
    frame_.image = cv::Mat(240, 320, CV_8U, cv::Scalar(7));
    frame_.pyramid = {frame_.image, frame_.image};
    frame_.picture = std::make_shared<Picture>();
    for (int i = 0; i < 200; ++i) {
      Keypoint keypoint;
      keypoint.x = keypoint.raw_x = static_cast<float>(random.Uniform(0, 319));
      keypoint.y = keypoint.raw_y = static_cast<float>(random.Uniform(0, 239));
      keypoint.depth = static_cast<float>(i + 1);
      frame_.keypoints.push_back(keypoint);
      Descriptor descriptor;
      descriptor.words[i % 4] = static_cast<uint64_t>(i);
      frame_.descriptors.push_back(descriptor);
    }
    frame_.grid = KeypointGrid(frame_.keypoints, 320, 240);
  }
  Camera camera_;
  Frame frame_;
};

TEST_F(SubsetTest, KeepsOfEachKeypointAllThatBelongsToIt) {
  for (int i = 0; i < 200; ++i) frame_.static_probability.push_back(static_cast<float>(i) / 200);
  const std::vector<int> kept = {0, 3, 4, 77, 150, 199};
  const Frame subset = KeypointSubset(frame_, kept, camera_);
  ASSERT_EQ(subset.keypoints.size(), kept.size());
  ASSERT_EQ(subset.descriptors.size(), kept.size());
  ASSERT_EQ(subset.static_probability.size(), kept.size());
  for (size_t k = 0; k < kept.size(); ++k) {
    EXPECT_EQ(subset.keypoints[k].depth, frame_.keypoints[kept[k]].depth);
    EXPECT_EQ(subset.keypoints[k].pixel(), frame_.keypoints[kept[k]].pixel());
    EXPECT_EQ(subset.descriptors[k], frame_.descriptors[kept[k]]);
    EXPECT_EQ(subset.static_probability[k], frame_.static_probability[kept[k]]);
  }
}

TEST_F(SubsetTest, IsOfTheSameMomentAndPicture) {
  const Frame subset = KeypointSubset(frame_, std::vector<int>{1}, camera_);
  EXPECT_EQ(subset.time, 4.5);
  EXPECT_EQ(subset.number, 17);
  EXPECT_EQ(subset.image.data, frame_.image.data);
  EXPECT_EQ(subset.pyramid.size(), 2u);
  EXPECT_EQ(subset.picture, frame_.picture);
}

TEST_F(SubsetTest, FindsItsOwnKeypointsByTheirNewNumbers) {
  std::vector<int> kept;
  for (int i = 0; i < 200; i += 3) kept.push_back(i);
  const Frame subset = KeypointSubset(frame_, kept, camera_);
  std::vector<int> found;
  subset.grid.VisitNear(160, 120, 1000, [&](int i) { found.push_back(i); });
  std::sort(found.begin(), found.end());
  ASSERT_EQ(found.size(), kept.size());
  for (size_t k = 0; k < kept.size(); ++k) EXPECT_EQ(found[k], static_cast<int>(k));
}

TEST_F(SubsetTest, WhereNothingIsKnownToMoveNothingIsInTheSubset) {
  const Frame subset = KeypointSubset(frame_, std::vector<int>{2, 5}, camera_);
  EXPECT_TRUE(subset.static_probability.empty());
  EXPECT_EQ(subset.Static(1), 1);
}

TEST_F(SubsetTest, MayBeEmpty) {
  const Frame subset = KeypointSubset(frame_, {}, camera_);
  EXPECT_TRUE(subset.keypoints.empty());
  int visited = 0;
  subset.grid.VisitNear(160, 120, 1000, [&](int) { ++visited; });
  EXPECT_EQ(visited, 0);
}

}  // namespace
}  // namespace alidade::subset_test
