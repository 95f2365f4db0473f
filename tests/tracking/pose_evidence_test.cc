#include "alidade/tracking/pose_evidence.h"

#include <gtest/gtest.h>

#include <cmath>

#include "alidade/base/random.h"

namespace alidade::pose_evidence_test {
namespace {

constexpr int kWidth = 640, kHeight = 480;
constexpr double kWindow = 4;  // σ

// `count` keypoints on level 0.
Frame FrameOf(int count) {
  Frame frame;
  frame.keypoints.resize(static_cast<size_t>(count));
  for (Keypoint& keypoint : frame.keypoints) keypoint.level = 0;
  return frame;
}

PoseEvidence Evidence(int keypoints = 1000, const PoseEvidenceSettings& settings = {}) {
  return {FrameOf(keypoints), kWidth, kHeight, {.sigma_px = 1}, kWindow, false, settings};
}

// Landmarks spread over the columns from `left` to `right`, of which `share` is found with errors
// of `sigma` (normal), or anywhere in the window (sigma 0).
void Spread(PoseEvidence& evidence, int landmarks, double share, double sigma, double left = 0,
            double right = kWidth) {
  Random random(1);
  for (int i = 0; i < landmarks; ++i) {
    const double u = left + random.Uniform() * (right - left), v = random.Uniform() * kHeight;
    if (random.Uniform() >= share) {
      evidence.Missed(u, v, 0);
    } else {
      const double chi2 = sigma > 0 ? -2 * sigma * sigma * std::log(1 - random.Uniform())
                                    : kWindow * kWindow * random.Uniform();
      evidence.Found(u, v, 0, chi2, -1);
    }
  }
}

double Ratio(int landmarks, double share, double sigma, int keypoints = 1000) {
  PoseEvidence evidence = Evidence(keypoints);
  Spread(evidence, landmarks, share, sigma);
  return evidence.LogLikelihoodRatio();
}

TEST(PoseEvidence, NothingExpectedSaysNothing) {
  EXPECT_NEAR(Evidence().LogLikelihoodRatio(), 0, 1e-9);
}

TEST(PoseEvidence, WhatIsFoundWhereItIsExpectedSpeaksForThePose) {
  EXPECT_GT(Ratio(400, 0.5, 1), 15);
  EXPECT_GT(Ratio(400, 0.25, 1), 5);
  EXPECT_LT(Ratio(400, 0.02, 0), -3);
  EXPECT_LT(Ratio(400, 0, 1), -5);
}

// The share alone does not decide: among many keypoints a similar one is near by chance.
TEST(PoseEvidence, ChanceGrowsWithTheDensityOfKeypoints) {
  EXPECT_GT(Ratio(400, 0.15, 0, 300), 0);
  EXPECT_LT(Ratio(400, 0.15, 0, 4000), 0);
}

TEST(PoseEvidence, ErrorsAllOverTheWindowSpeakAgainstIt) {
  EXPECT_GT(Ratio(400, 0.3, 1) - Ratio(400, 0.3, 0), 5);
  // A blurred frame is still told from chance by the share that is found.
  EXPECT_GT(Ratio(400, 0.4, 3), 5);
}

// One part of the image can be a look-alike: however well it agrees, it is not certain.
TEST(PoseEvidence, OnePartOfTheImageSaysLittle) {
  PoseEvidence evidence = Evidence();
  Spread(evidence, 400, 0.9, 0.5, 0, kWidth / 4 - 1);
  const PoseEvidenceSettings settings;
  EXPECT_LT(evidence.LogLikelihoodRatio(),
            3 * std::log((1 - settings.occluded) / settings.look_alike));
  // And what is hidden speaks against it no more than that a part can be hidden.
  PoseEvidence half = Evidence();
  Spread(half, 200, 0.5, 1, 0, kWidth / 2);
  Spread(half, 200, 0, 1, kWidth / 2, kWidth);
  EXPECT_GT(half.LogLikelihoodRatio(), 5);
}

TEST(PoseEvidence, TimeTakesCertaintyAway) {
  const PoseEvidenceSettings settings;
  const double sure = 20;
  EXPECT_EQ(AfterSeconds(sure, 0, settings), sure);
  const double frame = AfterSeconds(sure, 1.0 / 30, settings),
               second = AfterSeconds(sure, 1, settings);
  EXPECT_NEAR(Probability(frame), 1 - settings.jump_rate / 30, 1e-4);
  EXPECT_LT(second, frame);
  EXPECT_NEAR(Probability(second), std::exp(-settings.jump_rate), 1e-6);
  EXPECT_NEAR(LogOdds(Probability(2.5)), 2.5, 1e-9);
}

}  // namespace
}  // namespace alidade::pose_evidence_test
