// Temporary points on objects at rest: matched while consistent, dropped otherwise.
#include "alidade/tracking/passing_points.h"

#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <vector>

#include "support/vga_camera.h"

namespace alidade::passing_points_test {
namespace {

class PassingPointsTest : public testing::Test {
 protected:
  PassingPointsTest() {
    std::mt19937 random(3);
    for (int i = 0; i < 40; ++i) {
      world_.push_back({-1 + 0.25 * (i % 8), -0.6 + 0.3 * (i / 8), 2.5});
      for (auto& word : descriptors_.emplace_back().words) {
        word = random();
        word = (word << 32) ^ random();
      }
    }
  }
  // Frame of a camera `x` meters to the right, with static probability p for each keypoint.
  PlacedFrame Seen(double x, float p) const {
    auto frame = std::make_shared<Frame>();
    PlacedFrame placed;
    placed.T_camera_world.t.x() = -x;
    for (size_t i = 0; i < world_.size(); ++i) {
      const Eigen::Vector3d point = placed.T_camera_world * world_[i];
      const Eigen::Vector2d pixel = camera_.Project(point);
      Keypoint keypoint;
      keypoint.x = keypoint.raw_x = static_cast<float>(pixel.x());
      keypoint.y = keypoint.raw_y = static_cast<float>(pixel.y());
      keypoint.depth = static_cast<float>(point.z());
      frame->keypoints.push_back(keypoint);
      frame->descriptors.push_back(descriptors_[i]);
      frame->static_probability.push_back(p);
    }
    frame->grid = KeypointGrid(frame->keypoints, camera_.width, camera_.height);
    placed.matches.resize(world_.size());
    placed.frame = std::move(frame);
    return placed;
  }

  Camera camera_ = MakeVgaCamera();
  std::vector<Eigen::Vector3d> world_;
  std::vector<Descriptor> descriptors_;
  PassingPoints points_{camera_};
};

TEST_F(PassingPointsTest, AreFoundWhereTheyWere) {
  points_.Update(Seen(0, 0.3f), 0);
  const PlacedFrame later = Seen(0.1, 0.3f);
  const std::vector<PassingMatch> found = points_.Find(later, 4, 50);
  ASSERT_EQ(found.size(), world_.size());
  for (const PassingMatch& match : found)
    EXPECT_LT((match.p_world - world_[match.keypoint]).norm(), 1e-5);
}

TEST_F(PassingPointsTest, AreNeitherOfWhatMovesNorOfWhatIsCertain) {
  points_.Update(Seen(0, 0.02f), 0);
  EXPECT_EQ(points_.size(), 0u);
  points_.Update(Seen(0, 0.9f), 0);
  EXPECT_EQ(points_.size(), 0u);
  points_.Update(Seen(0, 0.3f), 0);
  EXPECT_TRUE(points_.Find(Seen(0, 0.02f), 4, 50).empty());  // starts to move
  PlacedFrame mapped = Seen(0, 0.3f);
  mapped.matches.assign(world_.size(), LandmarkId{1});
  EXPECT_TRUE(points_.Find(mapped, 4, 50).empty());
}

TEST_F(PassingPointsTest, AreKeptWhereTheyWereFirstSeenWhileTheyHold) {
  points_.Update(Seen(0, 0.3f), 0);
  PlacedFrame next = Seen(0.1, 0.3f);
  next.passing = points_.Find(next, 4, 50);
  next.T_camera_world.t.x() += 0.05;  // a wrong pose does not move known points
  points_.Update(next, 0);
  ASSERT_EQ(points_.size(), world_.size());
  for (const PassingMatch& match : points_.Find(Seen(0.1, 0.3f), 4, 50))
    EXPECT_LT((match.p_world - world_[match.keypoint]).norm(), 1e-5);
}

TEST_F(PassingPointsTest, AreTakenAnewWhenTheyDidNotAgreeAndWhenTheWorldMoved) {
  for (const uint64_t world : {0, 1}) {
    PassingPoints points(camera_);
    points.Update(Seen(0, 0.3f), 0);
    PlacedFrame next = Seen(0.1, 0.3f);
    if (world == 1) next.passing = points.Find(next, 4, 50);
    next.T_camera_world.t.x() = -0.3;  // moved by 0.2 m
    points.Update(next, world);
    ASSERT_EQ(points.size(), world_.size());
    for (const PassingMatch& match : points.Find(next, 4, 50))
      EXPECT_NEAR(match.p_world.x() - world_[match.keypoint].x(), 0.2, 1e-5);
  }
}

}  // namespace
}  // namespace alidade::passing_points_test
