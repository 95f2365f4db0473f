// Probabilities of features and evidence for landmarks, from the belief of the cells around them.
#include "alidade/dynamics/feature_belief.h"

#include <gtest/gtest.h>

#include <vector>

#include "alidade/base/log_odds.h"
#include "alidade/dynamics/landmark_belief.h"
#include "support/vga_camera.h"

namespace alidade::feature_belief_test {
namespace {

// A static wall at 4 m; the right half of the image is covered by a moving object at 2 m.
class BeliefOfAFrame : public testing::Test {
 protected:
  BeliefOfAFrame() {
    belief_.depth.assign(cells_.count(), 4);
    belief_.geometry.assign(cells_.count(), 3);
    belief_.object.assign(cells_.count(), 0);
    for (int i = 0; i < cells_.count(); ++i) {
      if (cells_.Centre(i).x < 320) continue;
      belief_.depth[i] = 2;
      belief_.geometry[i] = -3;
    }
    belief_.log_odds = belief_.geometry;
  }
  static Keypoint At(float x, float depth) {
    Keypoint keypoint;
    keypoint.x = keypoint.raw_x = x;
    keypoint.y = keypoint.raw_y = 240;
    keypoint.depth = depth;
    return keypoint;
  }
  std::vector<float> Of(const std::vector<Keypoint>& keypoints) const {
    return StaticProbabilities(cells_, belief_, DepthImage(image_, camera_), keypoints, settings_);
  }
  // Probability of one keypoint among many static ones.
  float Of(const Keypoint& keypoint) const {
    std::vector<Keypoint> keypoints(300, At(50, 4));
    keypoints[0] = keypoint;
    return Of(keypoints)[0];
  }
  Sight Look(float x, float z) const {
    return SightOf(cells_, belief_, z * camera_.Unproject({x, 240}), settings_.landmarks,
                   settings_.depth);
  }

  Camera camera_ = MakeVgaCamera();
  Cells cells_{camera_};
  FrameBelief belief_;
  DynamicsSettings settings_;
  cv::Mat image_;
};

TEST_F(BeliefOfAFrame, AFeatureTakesAfterTheSurfaceAtItsDepth) {
  const float moves = ProbabilityOf(-3);
  EXPECT_EQ(Of(At(100, 4)), 1);
  EXPECT_FLOAT_EQ(Of(At(500, 2)), moves);
  // On the outline, in cells of either side.
  for (float x : {317.0f, 323.0f}) {
    EXPECT_EQ(Of(At(x, 4)), 1) << x;
    EXPECT_FLOAT_EQ(Of(At(x, 2)), moves) << x;
  }
  // The surface is four cells away: found, unless the search is limited to nearer cells.
  EXPECT_EQ(Of(At(348, 4)), 1);
  settings_.features.far_cells = 2;
  EXPECT_FLOAT_EQ(Of(At(348, 4)), moves);
}

TEST_F(BeliefOfAFrame, AFeatureWithoutDepthHasThatOfTheNextReading) {
  EXPECT_FLOAT_EQ(Of(At(317, 0)), ProbabilityOf(-3));  // the lowest around it
  image_ = cv::Mat(480, 640, CV_32F, cv::Scalar(0));
  image_.at<float>(240, 319) = 4;
  EXPECT_EQ(Of(At(317, 0)), 1);
  settings_.features.reading_reach = 1;
  EXPECT_FLOAT_EQ(Of(At(317, 0)), ProbabilityOf(-3));
}

TEST_F(BeliefOfAFrame, FromSureOnItCountsFully) {
  for (float& log_odds : belief_.log_odds) log_odds = 1;
  settings_.features.sure = 0.8f;
  EXPECT_FLOAT_EQ(Of(At(100, 4)), ProbabilityOf(1));
  settings_.features.sure = 0.7f;
  EXPECT_EQ(Of(At(100, 4)), 1);
}

TEST_F(BeliefOfAFrame, TheUncertainHaveASayOnlyWhereFewAreCertain) {
  // Many features on an object that geometry does not consider moving, and some on the wall.
  for (int i = 0; i < cells_.count(); ++i) {
    if (cells_.Centre(i).x >= 480) belief_.geometry[i] = 1.5f;
  }
  std::vector<Keypoint> keypoints(400, At(560, 2));
  for (int k = 0; k < 130; ++k) keypoints[k] = At(50, 4);
  EXPECT_FLOAT_EQ(Of(keypoints)[399], ProbabilityOf(-3));
  for (int k = 100; k < 130; ++k) keypoints[k] = At(400, 2);  // geometry considers these moving
  EXPECT_FLOAT_EQ(Of(keypoints)[399], settings_.features.uncertain_weight);
  EXPECT_FLOAT_EQ(Of(keypoints)[110], ProbabilityOf(-3));
  settings_.features.enough_count = 90;
  EXPECT_FLOAT_EQ(Of(keypoints)[399], ProbabilityOf(-3));
  settings_.features.enough_share = 0.5f;
  EXPECT_FLOAT_EQ(Of(keypoints)[399], settings_.features.uncertain_weight);
}

TEST_F(BeliefOfAFrame, ALandmarkIsSeenHiddenOnAMoverOrGone) {
  EXPECT_EQ(Look(100, 4), Sight::kClear);
  EXPECT_EQ(Look(500, 2), Sight::kOnMover);
  EXPECT_EQ(Look(500, 4), Sight::kHidden);
  EXPECT_EQ(Look(100, 2), Sight::kGone);
  EXPECT_EQ(Look(-50, 2), Sight::kClear);  // outside the image
  // At the limits of the tolerance: 0.04 + 0.02 × 2 + 0.004 × 4 = 0.096 m.
  EXPECT_EQ(Look(500, 2.09f), Sight::kOnMover);
  EXPECT_EQ(Look(500, 2.15f), Sight::kHidden);
  settings_.depth.tolerance = 0.2f;
  EXPECT_EQ(Look(500, 2.15f), Sight::kOnMover);
}

TEST_F(BeliefOfAFrame, WhereHardlyAnyDepthIsKnownNothingIsSaidAgainstALandmark) {
  const int cell = cells_.At(500, 240);
  int left = 4;
  cells_.VisitAround(cell, 1, [&](int n) {
    if (left-- <= 0) belief_.depth[n] = 0;
  });
  EXPECT_EQ(Look(500, 2), Sight::kClear);
  settings_.landmarks.min_neighbours = 4;
  EXPECT_EQ(Look(500, 2), Sight::kOnMover);
}

TEST(LandmarkEvidence, IsWhatTheSettingsSay) {
  const LandmarkEvidenceSettings settings{
      .on_mover = -1, .gone = -2, .hidden_found = -3, .found = 4};
  EXPECT_EQ(EvidenceOf(Sight::kOnMover, true, settings), -1);
  EXPECT_EQ(EvidenceOf(Sight::kOnMover, false, settings), -1);
  EXPECT_EQ(EvidenceOf(Sight::kGone, false, settings), -2);
  EXPECT_EQ(EvidenceOf(Sight::kGone, true, settings), 0);
  EXPECT_EQ(EvidenceOf(Sight::kHidden, true, settings), -3);
  EXPECT_EQ(EvidenceOf(Sight::kHidden, false, settings), 0);
  EXPECT_EQ(EvidenceOf(Sight::kClear, true, settings), 4);
  EXPECT_EQ(EvidenceOf(Sight::kClear, false, settings), 0);
}

}  // namespace
}  // namespace alidade::feature_belief_test
