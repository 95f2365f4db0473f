#include "alidade/features/extractor.h"

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <set>

#include "alidade/base/error.h"
#include "alidade/base/parallel.h"
#include "alidade/features/matching.h"
#include "alidade/features/pyramid.h"
#include "support/texture.h"

namespace alidade::extractor_test {
namespace {

Camera CameraOf(const cv::Mat& image) {
  return Camera::FromFieldOfView(image.cols, image.rows, 60);
}

Frame Extract(const cv::Mat& image, ExtractorSettings settings = {}) {
  return Extractor(settings).Extract(image, CameraOf(image), 0, 0);
}

void ExpectSame(const Frame& a, const Frame& b) {
  ASSERT_EQ(a.keypoints.size(), b.keypoints.size());
  EXPECT_EQ(a.descriptors, b.descriptors);
  for (size_t i = 0; i < a.keypoints.size(); ++i) {
    const Keypoint &p = a.keypoints[i], &q = b.keypoints[i];
    EXPECT_TRUE(p.x == q.x && p.y == q.y && p.angle == q.angle && p.level == q.level &&
                p.response == q.response && p.raw_x == q.raw_x && p.raw_y == q.raw_y)
        << "keypoint " << i;
  }
}

TEST(Extractor, GivesTheSameWithOneAndWithManyThreads) {
  cv::Mat image = MakeTexture(503, 379, 1);
  AddNoise(image, 4, 2);
  SetThreadCount(1);
  const Frame alone = Extract(image);
  SetThreadCount(4);
  const Frame together = Extract(image);
  SetThreadCount(0);
  EXPECT_GT(alone.keypoints.size(), 500u);
  ExpectSame(alone, together);
}

TEST(Extractor, GivesTheSameFromAPartOfALargerImageAndTheSecondTime) {
  const cv::Mat large = MakeTexture(400, 300, 1);
  const cv::Mat part = large(cv::Rect(31, 17, 320, 240));
  Extractor extractor;
  const Frame first = extractor.Extract(part, CameraOf(part), 0, 0);
  // Another image size in between, so that the buffers are reallocated.
  extractor.Extract(large, CameraOf(large), 0, 0);
  ExpectSame(first, extractor.Extract(part.clone(), CameraOf(part), 0, 0));
  EXPECT_EQ(cv::norm(first.image, part, cv::NORM_INF), 0);
}

TEST(Extractor, GivesTheSameInPlace) {
  const cv::Mat one = MakeTexture(320, 240, 1), other = MakeTexture(320, 240, 2);
  Extractor extractor;
  const uint8_t* level_1 = nullptr;
  for (const cv::Mat& image : {one, other, one}) {
    const Frame frame = extractor.ExtractInPlace(image, CameraOf(image), 0, 0);
    ExpectSame(frame, Extract(image));
    EXPECT_EQ(frame.image.data, image.data);
    EXPECT_TRUE(!level_1 || frame.pyramid[1].data == level_1);
    level_1 = frame.pyramid[1].data;
  }
}

TEST(Extractor, KeepsItsOwnImage) {
  cv::Mat image = MakeTexture(320, 240, 1);
  const cv::Mat before = image.clone();
  const Frame frame = Extract(image);
  image.setTo(0);
  EXPECT_EQ(cv::norm(frame.image, before, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(frame.pyramid[0], before, cv::NORM_INF), 0);
}

TEST(Extractor, SortsByLevelThenRowThenColumn) {
  const Frame frame = Extract(MakeTexture(640, 480, 3));
  ASSERT_EQ(frame.keypoints.size(), frame.descriptors.size());
  for (size_t i = 1; i < frame.keypoints.size(); ++i) {
    const Keypoint &p = frame.keypoints[i - 1], &q = frame.keypoints[i];
    ASSERT_LE(p.level, q.level);
    if (p.level != q.level) continue;
    const double scale = ScaleOfLevel(p.level);
    // Sub-pixel refinement may move each position by up to 0.6 pixels.
    EXPECT_LE(FromLevelZero(p.y, scale), FromLevelZero(q.y, scale) + 1.25);
  }
}

TEST(Extractor, FindsNearlyAsManyAsAskedForOnAllLevels) {
  for (int wanted : {100, 500, 1000, 2000}) {
    ExtractorSettings settings;
    settings.features = wanted;
    const Frame frame = Extract(MakeTexture(640, 480, 3), settings);
    EXPECT_NEAR(static_cast<double>(frame.keypoints.size()), wanted, 8);  // rounding on 8 levels
    std::map<int, int> per_level;
    for (const Keypoint& k : frame.keypoints) ++per_level[k.level];
    EXPECT_EQ(per_level.size(), static_cast<size_t>(kPyramidLevels));
    EXPECT_GT(per_level[0], per_level[7]);
  }
}

TEST(Extractor, GivesAnEmptyFrameWhereThereIsNothingToSee) {
  for (double shade : {0.0, 128.0, 255.0}) {
    const Frame frame = Extract(cv::Mat(480, 640, CV_8UC1, cv::Scalar(shade)));
    EXPECT_TRUE(frame.keypoints.empty());
    EXPECT_TRUE(frame.descriptors.empty());
    EXPECT_EQ(frame.pyramid.size(), static_cast<size_t>(kPyramidLevels));
  }
  for (cv::Size size : {cv::Size(1, 1), cv::Size(38, 38), cv::Size(640, 20), cv::Size(5, 200)}) {
    EXPECT_TRUE(Extract(MakeTexture(size.width, size.height, 1)).keypoints.empty()) << size;
  }
}

TEST(Extractor, TakesSmallImages) {
  for (int side = 39; side < 90; side += 3) Extract(MakeTexture(side, side, 4));
}

TEST(Extractor, FindsCornersInAWeaklyTexturedRegionBesideAStrongOne) {
  // The right half has a fifth of the contrast: most of its steps are below the first threshold.
  cv::Mat image = MakeTexture(640, 480, 3);
  cv::Mat right = image.colRange(320, 640);
  right.convertTo(right, CV_8U, 0.2, 100);
  const Frame frame = Extract(image);
  int weak = 0;
  for (const Keypoint& k : frame.keypoints) weak += k.x > 345;
  EXPECT_GT(weak, 150);
  ExtractorSettings strong_only;
  strong_only.min_fast_threshold = strong_only.fast_threshold;
  int without = 0;
  for (const Keypoint& k : Extract(image, strong_only).keypoints) without += k.x > 345;
  EXPECT_LT(without, weak / 2);
}

TEST(Extractor, LeavesPixelNoiseAlone) {
  // Noise of 4 gray levels on a uniform wall: after the light smoothing 1.5, four times below the
  // threshold.
  cv::Mat image(480, 640, CV_8UC1, cv::Scalar(120));
  AddNoise(image, 4, 3);
  EXPECT_LT(Extract(image).keypoints.size(), 200u);
}

TEST(Extractor, PutsThePlaceOfACornerOnTheSameSpotFromAllLevels) {
  // A blob is found at its center on every level, so a wrong pixel center convention shows as a
  // drift over levels.
  cv::Mat image(480, 640, CV_8UC1, cv::Scalar(90));
  std::vector<cv::Point2d> centres;
  Random random(4);
  for (int y = 60; y < 440; y += 60) {
    for (int x = 60; x < 600; x += 60) {
      centres.emplace_back(x + random.Uniform(), y + random.Uniform());
    }
  }
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      double value = 90;
      for (const cv::Point2d& c : centres) {
        const double d2 = (x - c.x) * (x - c.x) + (y - c.y) * (y - c.y);
        if (d2 < 400) value += 120 * std::exp(-d2 / (2 * 2.0 * 2.0));
      }
      image.at<uint8_t>(y, x) = cv::saturate_cast<uint8_t>(value);
    }
  }
  const Frame frame = Extract(image);
  std::map<int, std::vector<Eigen::Vector2d>> off;
  for (const Keypoint& k : frame.keypoints) {
    for (const cv::Point2d& c : centres) {
      const Eigen::Vector2d d(k.x - c.x, k.y - c.y);
      if (d.norm() < 2 * ScaleOfLevel(k.level)) off[k.level].push_back(d);
    }
  }
  ASSERT_GE(off.size(), 6u);
  for (const auto& [level, all] : off) {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& d : all) mean += d / static_cast<double>(all.size());
    if (all.size() < 15) continue;
    // An error of half a pixel of the level would be (scale - 1) / 2 = 1.3 pixels at the top level.
    EXPECT_LT(mean.norm(), 0.1 * ScaleOfLevel(level))
        << "level " << level << ": " << mean.transpose();
  }
}

TEST(Extractor, UndistortsPositions) {
  const cv::Mat image = MakeTexture(640, 480, 3);
  Camera camera = CameraOf(image);
  camera.distortion = {-0.2, 0.05, 0.001, -0.002, 0};
  const Frame frame = Extractor().Extract(image, camera, 1.5, 7);
  EXPECT_EQ(frame.time, 1.5);
  EXPECT_EQ(frame.number, 7);
  double largest = 0;
  for (const Keypoint& k : frame.keypoints) {
    const Eigen::Vector2d back = camera.Distort(k.pixel());
    EXPECT_NEAR(back.x(), k.raw_x, 1e-3);
    EXPECT_NEAR(back.y(), k.raw_y, 1e-3);
    largest = std::max<double>(largest, std::abs(k.x - k.raw_x));
  }
  EXPECT_GT(largest, 5);
}

TEST(Extractor, RecognisesATurnedImage) {
  const cv::Mat image = MakeTexture(480, 480, 11);
  ExtractorSettings settings;
  settings.features = 600;
  cv::Mat noisy = image.clone();
  AddNoise(noisy, 3, 1);
  const Frame a = Extract(noisy, settings);
  for (double degrees : {0.0, 20.0, 45.0, 77.0, 110.0, 180.0, 251.0}) {
    const cv::Matx23d turn = cv::getRotationMatrix2D(cv::Point2f(239.5f, 239.5f), degrees, 1);
    cv::Mat turned;
    cv::warpAffine(image, turned, turn, image.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT_101);
    AddNoise(turned, 3, 2);
    const Frame b = Extract(turned, settings);
    int right = 0, inside = 0;
    const std::vector<IndexMatch> matches = MatchBruteForce(a, b, {.max_distance = 64});
    const auto map = [&](const Keypoint& k) {
      return Eigen::Vector2d(turn(0, 0) * k.x + turn(0, 1) * k.y + turn(0, 2),
                             turn(1, 0) * k.x + turn(1, 1) * k.y + turn(1, 2));
    };
    for (const Keypoint& k : a.keypoints) {
      inside += std::hypot(k.x - 239.5, k.y - 239.5) < 210;
    }
    for (const IndexMatch& m : matches) {
      const Keypoint& q = b.keypoints[m.b];
      right += (map(a.keypoints[m.a]) - q.pixel()).norm() < 2 * ScaleOfLevel(q.level);
    }
    // cv::ORB repeats a third to a half of its keypoints under such rotations.
    EXPECT_GT(right, 0.35 * inside) << degrees << " degrees, " << matches.size() << " matches";
    EXPECT_GT(right, 0.95 * static_cast<double>(matches.size())) << degrees << " degrees";
  }
}

TEST(Extractor, RefusesWhatItCannotTake) {
  Extractor extractor;
  const Camera camera = Camera::FromFieldOfView(64, 48, 60);
  EXPECT_THROW(extractor.Extract(cv::Mat(48, 64, CV_8UC3), camera, 0, 0), Error);
  EXPECT_THROW(extractor.Extract(cv::Mat(48, 64, CV_16UC1), camera, 0, 0), Error);
  EXPECT_THROW(extractor.Extract(cv::Mat(), camera, 0, 0), Error);
  EXPECT_THROW(extractor.Extract(cv::Mat(64, 48, CV_8UC1), camera, 0, 0), Error);
  for (auto change : std::vector<void (*)(ExtractorSettings&)>{
           [](ExtractorSettings& s) { s.features = 0; }, [](ExtractorSettings& s) { s.cell = 1; },
           [](ExtractorSettings& s) { s.min_fast_threshold = 0; },
           [](ExtractorSettings& s) { s.min_fast_threshold = 21; },
           [](ExtractorSettings& s) { s.fast_threshold = 256; },
           [](ExtractorSettings& s) { s.border = 18; },
           [](ExtractorSettings& s) { s.evenness = 1.1; },
           [](ExtractorSettings& s) { s.evenness = -0.1; }}) {
    ExtractorSettings settings;
    change(settings);
    EXPECT_THROW(settings.Check(), Error);
  }
}

}  // namespace
}  // namespace alidade::extractor_test
