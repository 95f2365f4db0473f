#include "alidade/features/fast.h"

#include <gtest/gtest.h>

#include <map>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "alidade/features/simd/fast_row.h"
#include "support/texture.h"

namespace alidade::fast_test {
namespace {

using Scores = std::map<std::pair<int, int>, int>;  // by row, column

Scores ScoresOf(const std::vector<Corner>& corners) {
  Scores scores;
  for (const Corner& c : corners) scores[{c.y, c.x}] = c.score;
  return scores;
}

Scores OpenCvScores(const cv::Mat& image, int threshold, bool suppress, int border) {
  std::vector<cv::KeyPoint> found;
  cv::FAST(image, found, threshold, suppress);
  Scores scores;
  for (const cv::KeyPoint& k : found) {
    const int x = static_cast<int>(k.pt.x), y = static_cast<int>(k.pt.y);
    if (x < border || y < border || x >= image.cols - border || y >= image.rows - border) continue;
    scores[{y, x}] = static_cast<int>(k.response);
  }
  return scores;
}

TEST(FastCorners, AreOpenCvsWithTheSameScoresAndOneOfEachTie) {
  constexpr int kBorder = 19;
  for (int threshold : {3, 7, 20, 60}) {
    cv::Mat image = MakeTexture(311, 200, 5);
    AddNoise(image, 3, 6);
    const Scores ours =
        ScoresOf(FastCorners(image, threshold, kBorder, kBorder, image.rows - kBorder));
    const Scores theirs = OpenCvScores(image, threshold, true, kBorder);
    const Scores unsuppressed = OpenCvScores(image, threshold, false, kBorder - 1);
    ASSERT_GT(theirs.size(), 20u);
    for (const auto& [place, score] : theirs) {
      ASSERT_TRUE(ours.count(place)) << place.first << ", " << place.second;
      EXPECT_EQ(ours.at(place), score);
    }
    // OpenCV drops both of two equal neighbors; FastCorners() keeps the first.
    for (const auto& [place, score] : ours) {
      ASSERT_TRUE(unsuppressed.count(place));
      if (theirs.count(place)) continue;
      bool tie = false;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const std::pair<int, int> beside{place.first + dy, place.second + dx};
          if (beside == place || !unsuppressed.count(beside)) continue;
          // Verify its score by detecting with both thresholds.
          const cv::Mat around = image(cv::Rect(beside.second - 4, beside.first - 4, 9, 9));
          std::vector<cv::KeyPoint> at_score, above;
          cv::FAST(around, at_score, score, false);
          cv::FAST(around, above, score + 1, false);
          const auto has_centre = [](const std::vector<cv::KeyPoint>& found) {
            return std::any_of(found.begin(), found.end(),
                               [](const cv::KeyPoint& k) { return k.pt == cv::Point2f(4, 4); });
          };
          EXPECT_FALSE(has_centre(above)) << "a stronger neighbour was not seen";
          tie = tie || has_centre(at_score);
        }
      }
      EXPECT_TRUE(tie) << "row " << place.first << ", column " << place.second;
    }
  }
}

TEST(FastCorners, AreTheSameInBandsAndInPartsOfLargerImages) {
  const cv::Mat large = MakeTexture(400, 300, 8);
  const cv::Mat image = large(cv::Rect(33, 21, 251, 201));
  const Scores whole = ScoresOf(FastCorners(image.clone(), 8, 19, 19, 201 - 19));
  Scores bands;
  for (int row = 19; row < 201 - 19; row += 31) {
    bands.merge(ScoresOf(FastCorners(image, 8, 19, row, std::min(row + 31, 201 - 19))));
  }
  EXPECT_EQ(bands, whole);
  EXPECT_GT(whole.size(), 50u);
}

// The same scores for any number of pixels at once, at any threshold and length of the row.
TEST(FastRow, IsTheSameHoweverManyPixelsAtOnce) {
  const cv::Mat image = MakeTexture(131, 90, 3);
  const auto stride = static_cast<ptrdiff_t>(image.step[0]);
  int found = 0;
  for (int end : {19, 34, 35, 36, 64, 100, 128}) {
    const FastRow fastest = FastRowFor(end);
    ASSERT_TRUE(fastest);
    for (int threshold : {0, 7, 40, 254, 255}) {
      for (int y = 3; y < image.rows - 3; ++y) {
        const auto look = [&](FastRow row, std::vector<uint8_t>& score) {
          std::vector<int> columns(image.cols);
          score.assign(image.cols, 0);
          columns.resize(row(image.ptr<uint8_t>(y), 3, end, stride, static_cast<uint8_t>(threshold),
                             score.data(), columns.data()));
          return columns;
        };
        std::vector<uint8_t> some, others;
        const std::vector<int> columns = look(FastRow16, some);
        EXPECT_EQ(look(fastest, others), columns) << end << ", " << threshold << ", " << y;
        EXPECT_EQ(others, some);
        found += static_cast<int>(columns.size());
      }
    }
  }
  EXPECT_GT(found, 5000);
  EXPECT_FALSE(FastRowFor(18));
}

TEST(FastCorners, AreNotLookedForWhereThereIsNoRoom) {
  for (int side = 1; side < 60; ++side) {
    const cv::Mat image = MakeTexture(side, side, 1);
    for (const Corner& c : FastCorners(image, 2, 19, 19, side - 19)) {
      EXPECT_GE(c.x, 19);
      EXPECT_LT(c.x, side - 19);
    }
  }
}

// A bright square corner with its tip between pixels, with exact pixel coverage and lens blur.
cv::Mat CornerAt(double x, double y, double turn) {
  constexpr int kSide = 48, kFine = 8;
  cv::Mat fine(kSide * kFine, kSide * kFine, CV_8UC1);
  for (int v = 0; v < fine.rows; ++v) {
    for (int u = 0; u < fine.cols; ++u) {
      const double dx = (u + 0.5) / kFine - 0.5 - x, dy = (v + 0.5) / kFine - 0.5 - y;
      const double a = std::cos(turn) * dx + std::sin(turn) * dy;
      const double b = std::cos(turn) * dy - std::sin(turn) * dx;
      fine.at<uint8_t>(v, u) = a > 0 && b > 0 ? 180 : 60;
    }
  }
  cv::Mat image;
  cv::resize(fine, image, cv::Size(kSide, kSide), 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(image, image, cv::Size(7, 7), 1);
  return image;
}

TEST(RefineCorner, FollowsACornerBetweenThePixels) {
  // The strongest point of a corner has a constant offset from its tip, so the test compares
  // displacements.
  Random random(9);
  double whole = 0, refined = 0;
  int count = 0;
  for (int trial = 0; trial < 12; ++trial) {
    const double turn = random.Uniform(0, 2 * std::numbers::pi);
    std::vector<Eigen::Vector2d> off_whole, off_refined;
    for (int step = 0; step < 12; ++step) {
      const Eigen::Vector2d tip(24 + random.Uniform(), 24 + random.Uniform());
      const cv::Mat image = CornerAt(tip.x(), tip.y(), turn);
      const std::vector<Corner> corners = FastCorners(image, 10, 18, 18, 30);
      ASSERT_FALSE(corners.empty());
      const Corner best =
          *std::max_element(corners.begin(), corners.end(),
                            [](const Corner& a, const Corner& b) { return a.score < b.score; });
      off_whole.push_back(Eigen::Vector2d(best.x, best.y) - tip);
      off_refined.push_back(RefineCorner(image, best) - tip);
    }
    const auto scatter = [](const std::vector<Eigen::Vector2d>& off) {
      Eigen::Vector2d mean = Eigen::Vector2d::Zero();
      for (const auto& o : off) mean += o / static_cast<double>(off.size());
      double sum = 0;
      for (const auto& o : off) sum += (o - mean).squaredNorm();
      return sum;
    };
    whole += scatter(off_whole);
    refined += scatter(off_refined);
    count += 2 * 12;
  }
  const double rms_whole = std::sqrt(whole / count), rms_refined = std::sqrt(refined / count);
  EXPECT_GT(rms_whole, 0.2);  // rounding to pixels: 1 / sqrt(12) = 0.29
  EXPECT_LT(rms_refined, 0.6 * rms_whole) << rms_whole << " -> " << rms_refined;
}

}  // namespace
}  // namespace alidade::fast_test
