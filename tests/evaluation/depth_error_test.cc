// Depth scores compared with values computed by hand.
#include "alidade/evaluation/depth_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "alidade/base/random.h"
#include "alidade/evaluation/image_edges.h"
#include "support/expect_error.h"

namespace alidade::depth_error_test {
namespace {

using testing::HasSubstr;

constexpr int kWidth = 64, kHeight = 48;

cv::Mat1f Depth(float z, int width = kWidth, int height = kHeight) {
  return cv::Mat1f(height, width, z);
}
cv::Mat1b Grey(uint8_t level, int width = kWidth, int height = kHeight) {
  return cv::Mat1b(height, width, level);
}

// An inclined plane, 2 m to 2.95 m away: continuous everywhere.
cv::Mat1f Leaning() {
  cv::Mat1f depth = Depth(0);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) depth(y, x) = 2 + 0.01f * x + 0.005f * y;
  }
  return depth;
}

DepthScores ScoreOne(const cv::Mat& estimate, const cv::Mat& truth, const cv::Mat& image,
                     const DepthErrorSettings& settings = {}) {
  const std::vector<DepthFrame> frames = {{estimate, truth, image}};
  return ScoreDepth(frames, settings).overall;
}

TEST(DepthError, IsThreePercentWhereEverythingIsThreePercentTooFar) {
  const cv::Mat1f truth = Leaning();
  const DepthScore score = ScoreOne(1.03f * truth, truth, Grey(0)).all;
  EXPECT_EQ(score.n, kWidth * kHeight);
  EXPECT_NEAR(score.median_rel, 0.03, 1e-6);
  EXPECT_NEAR(score.p90_rel, 0.03, 1e-6);
  EXPECT_EQ(score.within_2, 0);
  EXPECT_EQ(score.within_5, 1);
  EXPECT_EQ(score.within_10, 1);
  EXPECT_EQ(score.density, 1);
  double sum = 0;  // 1/z - 1/1.03 z
  for (const float z : truth) sum += std::pow((1 - 1 / 1.03) / z, 2);
  EXPECT_NEAR(score.rmse_inv, std::sqrt(sum / score.n), 1e-6);
}

TEST(DepthError, SharesAndQuantilesAreCountedExactly) {
  // Ten rows with errors of 1, 1, 1, 1, 4, 4, 4, 8, 8 and 30 %.
  const cv::Mat1f truth = Depth(2, 10, 10);
  cv::Mat1f estimate = truth.clone();
  const double errors[] = {30, 1, 8, 4, 1, -4, -1, 8, 4, -1};
  for (int y = 0; y < 10; ++y) estimate.row(y) *= 1 + errors[y] / 100;
  const DepthScore score = ScoreOne(estimate, truth, Grey(0, 10, 10)).all;
  EXPECT_NEAR(score.median_rel, 0.04, 1e-6);
  EXPECT_NEAR(score.p90_rel, 0.08, 1e-6);
  EXPECT_NEAR(score.within_2, 0.4, 1e-9);
  EXPECT_NEAR(score.within_5, 0.7, 1e-9);
  EXPECT_NEAR(score.within_10, 0.9, 1e-9);
}

TEST(DepthError, MedianOfAnEvenNumberIsTheMeanOfTheMiddleTwo) {
  const cv::Mat1f truth = Depth(1, 2, 2);
  const cv::Mat1f estimate = (cv::Mat1f(2, 2) << 1.01f, 1.02f, 1.06f, 1.5f);
  EXPECT_NEAR(ScoreOne(estimate, truth, Grey(0, 2, 2)).all.median_rel, 0.04, 1e-6);
}

TEST(DepthError, OneScaleIsFittedToAllFramesOfAMap) {
  // The unit is 2.5 m; a third of the first frame has large errors, to which the median is robust.
  const cv::Mat1f truth = Leaning();
  cv::Mat1f first = truth / 2.5f, second = Depth(3) / 2.5f;
  first.rowRange(0, kHeight / 3) *= 1.7f;
  const std::vector<DepthFrame> frames = {{first, truth, Grey(0)}, {second, Depth(3), Grey(0)}};
  const DepthErrorResult fitted = ScoreDepth(frames, {.fit_scale = true});
  EXPECT_NEAR(fitted.overall.all.scale, 2.5, 1e-6);
  EXPECT_LT(fitted.overall.all.median_rel, 1e-6);
  EXPECT_NEAR(fitted.overall.all.within_10, 5.0 / 6, 1e-9);
  EXPECT_NEAR(fitted.frames[0].all.within_10, 2.0 / 3, 1e-9);
  EXPECT_NEAR(fitted.frames[1].all.within_10, 1, 1e-9);
  const DepthErrorResult plain = ScoreDepth(frames);
  EXPECT_EQ(plain.overall.all.scale, 1);
  EXPECT_NEAR(plain.overall.all.median_rel, 0.6, 1e-6);
}

TEST(DepthError, EachMapHasAScaleOfItsOwn) {
  const cv::Mat1f truth = Leaning();
  const std::vector<DepthFrame> frames = {{truth / 2, truth, Grey(0), 0},
                                          {truth / 5, truth, Grey(0), 1}};
  const DepthErrorResult result = ScoreDepth(frames, {.fit_scale = true});
  EXPECT_NEAR(result.scales.at(0), 2, 1e-6);
  EXPECT_NEAR(result.scales.at(1), 5, 1e-6);
  EXPECT_NEAR(result.overall.all.scale, 2, 1e-6);
  EXPECT_NEAR(result.frames[1].all.scale, 5, 1e-6);
  EXPECT_LT(result.overall.all.p90_rel, 1e-6);
}

TEST(DepthError, PixelsNearDepthStepsAndOutliersOfTheTruthAreNoContinuousOnes) {
  // Two planes meet at column 32. The window reaches 7 pixels to each side, so columns 25 to 38
  // contain the step. The estimate is wrong only there.
  cv::Mat1f truth = Depth(2);
  truth.colRange(32, kWidth) = 3;
  cv::Mat1f estimate = truth.clone();
  estimate.colRange(25, 39) *= 1.5f;
  const DepthScores step = ScoreOne(estimate, truth, Grey(0));
  EXPECT_EQ(step.continuous.n, (kWidth - 14) * kHeight);
  EXPECT_EQ(step.continuous.within_2, 1);
  EXPECT_NEAR(step.all.within_2, 1 - 14.0 / kWidth, 1e-9);
  EXPECT_EQ(step.continuous.density, 1);  // density does not depend on the truth

  cv::Mat1f spot = Depth(2);
  spot(24, 32) = 2.2f;
  EXPECT_EQ(ScoreOne(spot, spot, Grey(0)).continuous.n, kWidth * kHeight - 15 * 15);
  spot(24, 32) = 2.08f;  // 4 %
  EXPECT_EQ(ScoreOne(spot, spot, Grey(0)).continuous.n, kWidth * kHeight);
}

TEST(DepthError, UnknownTruthIsNotScoredAndDisturbsNoNeighbour) {
  cv::Mat1f truth = Depth(2);
  truth.rowRange(10, 14) = 0;
  truth(0, 0) = std::numeric_limits<float>::quiet_NaN();
  truth(0, 1) = std::numeric_limits<float>::infinity();
  const DepthScores scores = ScoreOne(Depth(2), truth, Grey(0));
  EXPECT_EQ(scores.all.n, kWidth * (kHeight - 4) - 2);
  EXPECT_EQ(scores.continuous.n, scores.all.n);
  EXPECT_EQ(scores.all.median_rel, 0);
  EXPECT_EQ(scores.all.density, 1);
}

// The same, computed by plain loops.
TEST(DepthError, AgreesWithPlainLoopsOnRandomDepth) {
  Random random(11);
  cv::Mat1f truth = Leaning(), estimate = Depth(0);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (random.Uniform() < 0.1) truth(y, x) = 0;
      if (random.Uniform() < 0.003) truth(y, x) *= 1.2f;
      if (random.Uniform() < 0.4)
        estimate(y, x) = static_cast<float>((2 + 0.01 * x) * (1 + 0.05 * random.Gaussian()) / 3);
    }
  }
  std::vector<double> ratios, all, continuous;
  for (const bool errors : {false, true}) {  // first the scale
    std::sort(ratios.begin(), ratios.end());
    const size_t half = ratios.size() / 2;
    const double scale = !errors                  ? 0
                         : ratios.size() % 2 == 1 ? ratios[half]
                                                  : (ratios[half - 1] + ratios[half]) / 2;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const float z = truth(y, x);
        if (z == 0 || estimate(y, x) == 0) continue;
        bool close = true;
        for (int v = std::max(y - 7, 0); v <= std::min(y + 7, kHeight - 1); ++v) {
          for (int u = std::max(x - 7, 0); u <= std::min(x + 7, kWidth - 1); ++u)
            close &= truth(v, u) == 0 || std::abs(truth(v, u) - z) <= 0.05 * z;
        }
        if (!errors) ratios.push_back(z / estimate(y, x));
        if (!errors) continue;
        all.push_back(std::abs(scale * estimate(y, x) - z) / z);
        if (close) continuous.push_back(all.back());
      }
    }
  }
  const std::vector<DepthFrame> frames = {{estimate, truth, Grey(0)}};
  const DepthScores scores = ScoreDepth(frames, {.fit_scale = true}).overall;
  for (auto [score, errors] : {std::pair{scores.all, all}, {scores.continuous, continuous}}) {
    ASSERT_EQ(score.n, static_cast<int64_t>(errors.size()));
    ASSERT_GT(score.n, 50);
    std::sort(errors.begin(), errors.end());
    const size_t n = errors.size();
    EXPECT_NEAR(score.median_rel, (errors[(n - 1) / 2] + errors[n / 2]) / 2, 1e-6);
    EXPECT_NEAR(score.p90_rel, errors[(9 * n + 9) / 10 - 1], 1e-6);
    const auto within = std::upper_bound(errors.begin(), errors.end(), 0.05) - errors.begin();
    EXPECT_NEAR(score.within_5, static_cast<double>(within) / static_cast<double>(n), 1e-3);
  }
  EXPECT_LT(scores.continuous.n, scores.all.n);
}

TEST(DepthError, DensityIsOfAllPixelsAndOfThoseWithStructure) {
  // A dark and a bright half: Scharr detects columns 31 and 32. One of them has depth, and a
  // quarter of the other pixels.
  cv::Mat1b image = Grey(50);
  image.colRange(32, kWidth) = 150;
  cv::Mat1f estimate = Depth(0);
  estimate.col(31) = 2;
  estimate.colRange(0, 16) = 2;
  const DepthScore score = ScoreOne(estimate, Depth(2), image).all;
  EXPECT_NEAR(score.density, 17.0 / kWidth, 1e-9);
  EXPECT_NEAR(score.density_gradient, 0.5, 1e-9);
  EXPECT_NEAR(score.edge_coverage, 1, 1e-9);
  // A step of 15 gray levels has a gradient of 7.5 per pixel on each side, below the threshold.
  image.colRange(32, kWidth) = 65;
  EXPECT_TRUE(std::isnan(ScoreOne(estimate, Depth(2), image).all.density_gradient));
  const DepthScore faint = ScoreOne(estimate, Depth(2), image, {.min_gradient = 7}).all;
  EXPECT_NEAR(faint.density_gradient, 0.5, 1e-9);
}

TEST(DepthError, AnEdgeIsCoveredByDepthOnItOrBesideIt) {
  cv::Mat1b image = Grey(50);
  image.colRange(32, kWidth) = 150;
  cv::GaussianBlur(image, image, {5, 5}, 1);
  const ImageEdges edges = FindImageEdges(image, 8);
  EXPECT_EQ(cv::countNonZero(edges.edge), kHeight - 2);  // one pixel per row
  const int column = edges.edge(20, 31) != 0 ? 31 : 32;
  for (const int distance : {-2, -1, 0, 1, 2}) {
    cv::Mat1f estimate = Depth(0);
    estimate.col(column + distance).rowRange(0, kHeight / 2) = 2;
    const double covered = ScoreOne(estimate, Depth(2), image).all.edge_coverage;
    // Of rows 1 to 46, rows 1 to 24 are covered, the last one by the pixel above it.
    EXPECT_NEAR(covered, std::abs(distance) <= 1 ? 24.0 / 46 : 0, 1e-9) << distance;
  }
}

TEST(DepthError, ThinnedEdgesFollowADiscInEveryDirection) {
  cv::Mat1b image(200, 200, uint8_t{40});
  cv::circle(image, {100, 100}, 60, 200, cv::FILLED, cv::LINE_AA);
  cv::GaussianBlur(image, image, {0, 0}, 1.2);
  const ImageEdges edges = FindImageEdges(image, 8);
  std::vector<cv::Point> points;
  cv::findNonZero(edges.edge, points);
  std::vector<bool> seen(72, false);
  for (const cv::Point& p : points) {
    const double dx = p.x - 100, dy = p.y - 100;
    EXPECT_NEAR(std::hypot(dx, dy), 60, 1.5);
    seen[static_cast<size_t>((std::atan2(dy, dx) + CV_PI) / (2 * CV_PI) * 71.999)] = true;
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), true), 72);
  // A line, not a band: a chain around a circle has 8 r / √2 pixels with diagonal steps where
  // possible, 8 r without any.
  EXPECT_GT(static_cast<double>(points.size()), 0.95 * 8 * 60 / std::sqrt(2));
  EXPECT_LT(static_cast<double>(points.size()), 8 * 60);
  EXPECT_GT(cv::countNonZero(edges.gradient), 3 * static_cast<int>(points.size()));
}

TEST(DepthError, ASmallerEstimateIsJudgedAtItsOwnResolution) {
  // Each column has its own true depth. Pixel x of the half-size estimate lies between columns 2x
  // and 2x + 1 and gets the latter.
  cv::Mat1f truth = Depth(0);
  for (int x = 0; x < kWidth; ++x) truth.col(x) = 1.f + 0.001f * x;
  cv::Mat1f half = Depth(0, kWidth / 2, kHeight / 2);
  for (int x = 0; x < half.cols; ++x) half.col(x) = 1.f + 0.001f * (2 * x + 1);
  cv::Mat1b image = Grey(50);
  image.colRange(32, kWidth) = 150;
  const DepthScore score = ScoreOne(half, truth, image).all;
  EXPECT_EQ(score.n, kWidth * kHeight / 4);
  EXPECT_LT(score.p90_rel, 1e-6);
  EXPECT_EQ(score.density, 1);
  EXPECT_EQ(score.density_gradient, 1);
  // Ratio 2.5: pixel x has its center at 2.5 x + 0.75, which is rounded to the nearest column.
  cv::Mat1f coarse = Depth(0, 26, 19);
  for (int x = 0; x < coarse.cols; ++x) {
    coarse.col(x) = 1.f + 0.001f * std::round((x + 0.5f) * kWidth / 26 - 0.5f);
  }
  EXPECT_LT(ScoreOne(coarse, truth, image).all.p90_rel, 1e-6);
}

TEST(DepthError, WithoutAnyDepthThereIsNothingToTell) {
  cv::Mat1b image = Grey(50);
  image.colRange(32, kWidth) = 150;
  for (const bool fit : {false, true}) {
    const DepthScores scores = ScoreOne(Depth(0), Depth(2), image, {.fit_scale = fit});
    for (const DepthScore& score : {scores.all, scores.continuous}) {
      EXPECT_EQ(score.n, 0);
      EXPECT_TRUE(std::isnan(score.median_rel));
      EXPECT_TRUE(std::isnan(score.within_5));
      EXPECT_TRUE(std::isnan(score.rmse_inv));
      EXPECT_EQ(score.density, 0);
      EXPECT_EQ(score.density_gradient, 0);
      EXPECT_EQ(score.edge_coverage, 0);
      EXPECT_EQ(std::isnan(score.scale), fit);
    }
  }
  const DepthErrorResult none = ScoreDepth({});
  EXPECT_EQ(none.overall.all.n, 0);
  EXPECT_TRUE(std::isnan(none.overall.all.density));
}

TEST(DepthError, ImagesThatDoNotBelongTogetherAreRefused) {
  const auto message = [](const DepthFrame& frame) {
    return MessageOf(ErrorKind::kInput, [&] { DepthScorer().Add(frame); });
  };
  EXPECT_THAT(message({Depth(1, 64, 40), Depth(1), Grey(0)}), HasSubstr("64x40 does not fit"));
  EXPECT_THAT(message({Depth(1, 128, 96), Depth(1), Grey(0)}), HasSubstr("128x96"));
  EXPECT_THAT(message({Depth(1), Depth(1), Grey(0, 32, 24)}), HasSubstr("32x24"));
  EXPECT_THAT(message({Grey(1), Depth(1), Grey(0)}), HasSubstr("float"));
  EXPECT_THAT(message({cv::Mat1f(), Depth(1), Grey(0)}), HasSubstr("empty"));
  EXPECT_THAT(ComplaintAbout(DepthErrorSettings{.continuity_window = 4}), HasSubstr("odd"));
  EXPECT_THAT(ComplaintAbout(DepthErrorSettings{.min_gradient = -1}), HasSubstr("min_gradient"));
  EXPECT_THAT(ComplaintAbout(DepthErrorSettings{.continuity = 0}), HasSubstr("continuity"));
  EXPECT_EQ(ComplaintAbout(DepthErrorSettings{}), "");
}

}  // namespace
}  // namespace alidade::depth_error_test
