#include "alidade/semidense/epipolar_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "alidade/base/random.h"
#include "alidade/semidense/partners.h"
#include "support/dense_world.h"
#include "support/texture.h"

namespace alidade::epipolar_search_test {
namespace {

struct Errors {
  std::vector<double> relative;  // |found - true| / true of inverse depth
  std::vector<double> by_sigma;  // |found - true| / sigma
  size_t edges = 0;

  static double Median(std::vector<double> values) {
    if (values.empty()) return NAN;
    std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
    return values[values.size() / 2];
  }
  double Share(double bound) const {
    const auto within = std::count_if(relative.begin(), relative.end(),
                                      [&](double error) { return error < bound; });
    return static_cast<double>(within) / static_cast<double>(relative.size());
  }
};

Hypothesis Find(EpipolarSearch& search, const EdgePixel& pixel,
                std::span<const DepthInterval> intervals, SearchCount& count) {
  const EpipolarQuery query{pixel, intervals};
  std::array<Hypothesis, 1> found;
  search.Search({&query, 1}, found, count);
  return found[0];
}

// Searches all edge pixels of a view in another one, between 1 and 8 meters.
Errors SearchAll(const DenseView& reference, const DenseView& other, const Camera& camera,
                 const Exposure& exposure = {}, const SemiDenseSettings& settings = {}) {
  const GradientImageMaker maker(camera, settings.min_gradient, settings.gradient_weight);
  const GradientImage a = maker.Make({reference.image}), b = maker.Make({other.image});
  const EpipolarPair pair{a, b, WithExposure(a.values, exposure),
                          other.T_camera_world * reference.T_camera_world.Inverse()};
  EpipolarSearch search(pair, camera, settings);
  SearchCount count;
  const std::vector<DepthInterval> range = {{1 / 8.0f, 1.0f}};
  Errors errors;
  errors.edges = a.edges.size();
  for (const EdgePixel& edge : a.edges) {
    const Hypothesis h = Find(search, edge, range, count);
    if (!h.known()) continue;
    const double truth = 1 / reference.depth.at<float>(edge.y, edge.x);
    errors.relative.push_back(std::abs(h.inverse_depth - truth) / truth);
    errors.by_sigma.push_back(std::abs(h.inverse_depth - truth) / h.sigma);
  }
  return errors;
}

class EpipolarSearchTest : public testing::Test {
 protected:
  const DenseWorld world_;
  const Camera& camera_ = world_.camera();
};

TEST_F(EpipolarSearchTest, FindsTheDepthOfASidewaysStep) {
  const Errors errors =
      SearchAll(world_.Look(CameraAt({0, 0, 0})),
                world_.Look(CameraAt({0.2, 0.02, 0}), {.noise_seed = 2}), camera_);
  EXPECT_GT(errors.relative.size(), errors.edges / 2);
  EXPECT_LT(Errors::Median(errors.relative),
            0.015);                    // 17 pixels of disparity at 3 m: a quarter of a pixel
  EXPECT_GT(errors.Share(0.05), 0.8);  // a single pair: some matches are wrong
  // The standard deviation is neither too small nor far too large.
  EXPECT_LT(Errors::Median(errors.by_sigma), 1);
  EXPECT_GT(Errors::Median(errors.by_sigma), 0.1);
}

TEST_F(EpipolarSearchTest, FindsTheDepthOfAStepForward) {
  const Errors errors =
      SearchAll(world_.Look(CameraAt({0, 0, 0})),
                world_.Look(CameraAt({0.02, 0, 0.4}), {.noise_seed = 2}), camera_);
  EXPECT_GT(errors.relative.size(), errors.edges / 4);  // none near the epipole
  EXPECT_LT(Errors::Median(errors.relative), 0.03);
}

TEST_F(EpipolarSearchTest, FollowsARolledCamera) {
  Vector6d roll = Vector6d::Zero();
  roll[5] = 0.6;  // about the optical axis
  const Errors errors =
      SearchAll(world_.Look(CameraAt({0, 0, 0})),
                world_.Look(Se3::Exp(roll) * CameraAt({0.2, 0, 0}), {.noise_seed = 2}), camera_);
  EXPECT_GT(errors.relative.size(), errors.edges / 4);
  EXPECT_LT(Errors::Median(errors.relative), 0.03);
}

TEST_F(EpipolarSearchTest, ExposuresAreEvenedOut) {
  const DenseView reference = world_.Look(CameraAt({0, 0, 0}));
  const DenseView darker =
      world_.Look(CameraAt({0.2, 0, 0}), {.gain = 0.7, .offset = 10, .noise_seed = 2});
  const Errors with = SearchAll(reference, darker, camera_, {0.7, 10});
  const Errors without = SearchAll(reference, darker, camera_);
  EXPECT_GT(with.relative.size(), 1.3 * without.relative.size());
  EXPECT_LT(Errors::Median(with.relative), 0.02);
}

TEST_F(EpipolarSearchTest, AnotherPlaceHasFewMatches) {
  const DenseWorld elsewhere(77);
  const Errors errors =
      SearchAll(world_.Look(CameraAt({0, 0, 0})), elsewhere.Look(CameraAt({0.2, 0, 0})), camera_);
  EXPECT_LT(errors.relative.size(), errors.edges / 3);
}

TEST_F(EpipolarSearchTest, ATurnOnTheSpotTellsNothing) {
  const Errors errors =
      SearchAll(world_.Look(CameraAt({0, 0, 0})),
                world_.Look(CameraAt({0, 0, 0}, 0.05), {.noise_seed = 2}), camera_);
  EXPECT_EQ(errors.relative.size(), 0u);
}

TEST_F(EpipolarSearchTest, EdgesAlongTheLineAreLeftOut) {
  // Horizontal stripes and a translation along them.
  cv::Mat stripes(camera_.height, camera_.width, CV_8U);
  for (int y = 0; y < stripes.rows; ++y) {
    stripes.row(y) = static_cast<uint8_t>(128 + 100 * std::sin(y / 3.0));
  }
  DenseView a{CameraAt({0, 0, 0}), stripes, cv::Mat(stripes.size(), CV_32F, cv::Scalar(3))};
  DenseView b{CameraAt({0.2, 0, 0}), stripes, a.depth};
  EXPECT_EQ(SearchAll(a, b, camera_).relative.size(), 0u);
}

TEST_F(EpipolarSearchTest, WhatMovesInTheOtherIsNoMatch) {
  const DenseView reference = world_.Look(CameraAt({0, 0, 0}));
  const DenseView other = world_.Look(CameraAt({0.2, 0, 0}), {.noise_seed = 2});
  const SemiDenseSettings settings;
  const GradientImageMaker maker(camera_, settings.min_gradient, settings.gradient_weight);
  const cv::Mat all(camera_.height, camera_.width, CV_8U, cv::Scalar(255));
  const GradientImage a = maker.Make({reference.image}), b = maker.Make({other.image, {}, {}, all});
  const EpipolarPair pair{a, b, a.values,
                          other.T_camera_world * reference.T_camera_world.Inverse()};
  EpipolarSearch search(pair, camera_, settings);
  SearchCount count;
  const std::vector<DepthInterval> range = {{1 / 8.0f, 1.0f}};
  for (const EdgePixel& edge : a.edges) EXPECT_FALSE(Find(search, edge, range, count).known());
  EXPECT_GT(count.searches, 1000);
}

// `picture` inside a larger image filled with `value`.
cv::Mat Framed(const cv::Mat& picture, double value) {
  constexpr int kBeside = 40;  // pixels
  cv::Mat frame;
  cv::copyMakeBorder(picture, frame, kBeside, kBeside, kBeside, kBeside, cv::BORDER_CONSTANT,
                     cv::Scalar::all(value));
  return frame(cv::Rect({kBeside, kBeside}, picture.size()));
}

// For any cameras, poses and intervals, the memory around the images must not affect the result.
TEST(EpipolarSearch, ReadsNothingBesideThePictures) {
  Random random(11);
  const SemiDenseSettings settings;
  SearchCount count;
  int found = 0;
  std::vector<LineSearch> searches = {LineSearch4};
#ifdef ALIDADE_AVX2
  if (HasAvx2()) searches.push_back(LineSearch8);
#endif
  for (int round = 0; round < 60; ++round) {
    Camera camera;
    camera.width = static_cast<int>(random.Uniform(20, 200));
    camera.height = static_cast<int>(random.Uniform(20, 150));
    camera.fx = camera.width * std::exp(random.Uniform(-1.5, 2));
    camera.fy = camera.fx * random.Uniform(0.7, 1.4);
    camera.cx = camera.width * random.Uniform(-0.2, 1.2);
    camera.cy = camera.height * random.Uniform(-0.2, 1.2);
    const GradientImageMaker maker(camera, settings.min_gradient, settings.gradient_weight);
    GradientImage reference, other;
    for (GradientImage* image : {&reference, &other}) {
      cv::Mat gray = MakeTexture(camera.width, camera.height, random.Next());
      *image = maker.Make({gray});
    }
    for (int pose = 0; pose < 4; ++pose) {
      const double length = std::pow(10, random.Uniform(-3, 3));
      const double turn = std::pow(10, random.Uniform(-4, 0.3));
      Vector6d xi;
      for (int i = 0; i < 6; ++i) xi[i] = random.Uniform(-1, 1) * (i < 3 ? length : turn);
      if (pose == 1) xi.tail<3>().setZero();
      if (pose == 2) xi[2] = 0;
      std::vector<EpipolarPair> pairs;
      std::vector<GradientImage> others;
      for (const double beside : {0.0, 251.0}) {
        others.push_back({Framed(other.values, beside), Framed(other.direction, beside), {}, {}});
      }
      for (size_t i = 0; i < 2; ++i) {
        pairs.push_back(
            {reference, others[i], Framed(reference.values, i == 0 ? 0 : 251), Se3::Exp(xi)});
      }
      const LineSearch search = searches[static_cast<size_t>(round) % searches.size()];
      EpipolarSearch one(pairs[0], camera, settings, search);
      EpipolarSearch two(pairs[1], camera, settings, search);
      for (size_t i = 0; i < reference.edges.size(); i += 1 + reference.edges.size() / 300) {
        const auto middle = static_cast<float>(std::pow(10, random.Uniform(-2, 1)) / length);
        const auto share = static_cast<float>(std::pow(10, random.Uniform(-5, 0.3)));
        const std::vector<DepthInterval> range = {
            {middle * std::max(0.0f, 1 - share), middle * (1 + share)}};
        const Hypothesis a = Find(one, reference.edges[i], range, count);
        const Hypothesis b = Find(two, reference.edges[i], range, count);
        ASSERT_EQ(a.inverse_depth, b.inverse_depth);
        ASSERT_EQ(a.sigma, b.sigma);
        found += a.known();
      }
    }
  }
  EXPECT_GT(found, 500);
}

// Inverse depth and sigma of every edge pixel, searched in one to three intervals.
std::vector<float> FoundWith(LineSearch search, const EpipolarPair& pair, const Camera& camera,
                             SearchCount& count) {
  const SemiDenseSettings settings;
  EpipolarSearch searcher(pair, camera, settings, search);
  const std::array<DepthInterval, kMostIntervals> parts = {
      {{0.3f, 0.4f}, {0.125f, 0.25f}, {0.1f, 1.0f}}};
  const std::vector<EdgePixel>& edges = pair.reference->edges;
  std::vector<float> bits;
  for (size_t i = 0; i < edges.size(); i += searcher.lanes()) {
    const size_t n = std::min<size_t>(searcher.lanes(), edges.size() - i);
    std::array<EpipolarQuery, kMostLanes> queries;
    std::array<Hypothesis, kMostLanes> found;
    for (size_t k = 0; k < n; ++k) queries[k] = {edges[i + k], {parts.data(), 1 + (i + k) % 3}};
    searcher.Search({queries.data(), n}, found, count);
    for (size_t k = 0; k < n; ++k) {
      bits.push_back(found[k].inverse_depth);
      bits.push_back(found[k].sigma);
    }
  }
  return bits;
}

TEST_F(EpipolarSearchTest, IsTheSameToTheBitWithEightLanes) {
#ifdef ALIDADE_AVX2
  if (!HasAvx2()) GTEST_SKIP() << "no AVX2";
  const SemiDenseSettings settings;
  const GradientImageMaker maker(camera_, settings.min_gradient, settings.gradient_weight);
  const DenseView from = world_.Look(CameraAt({0, 0, 0}));
  Vector6d roll = Vector6d::Zero();
  roll[5] = 0.3;
  for (const Se3& T : {CameraAt({0.2, 0.02, 0}), CameraAt({0.02, 0.3, 0}), CameraAt({0.02, 0, 0.4}),
                       Se3::Exp(roll) * CameraAt({0.2, 0, 0})}) {
    const GradientImage a = maker.Make({from.image});
    const GradientImage b = maker.Make({world_.Look(T, {.noise_seed = 2}).image});
    const EpipolarPair pair{a, b, a.values, T * from.T_camera_world.Inverse()};
    SearchCount four, eight;
    const std::vector<float> expected = FoundWith(LineSearch4, pair, camera_, four);
    const std::vector<float> found = FoundWith(LineSearch8, pair, camera_, eight);
    EXPECT_EQ(found, expected);
    EXPECT_GT(std::count_if(found.begin(), found.end(), [](float x) { return x > 0; }), 1000);
    EXPECT_EQ(eight.searches, four.searches);
    EXPECT_EQ(eight.samples, four.samples);
  }
#else
  GTEST_SKIP() << "no AVX2";
#endif
}

TEST(WithExposure, IsGainAndOffsetOfEveryPixel) {
  cv::Mat values(5, 21, CV_8UC2);  // not a multiple of the number of lanes
  for (int i = 0; i < 105; ++i) {
    values.at<cv::Vec2b>(i / 21, i % 21) = {static_cast<uint8_t>(2 * i), static_cast<uint8_t>(i)};
  }
  const cv::Mat changed = WithExposure(values, {1.4, -20});
  for (int i = 0; i < 105; ++i) {
    const auto& pixel = changed.at<cv::Vec2b>(i / 21, i % 21);
    EXPECT_NEAR(pixel[0], std::clamp(1.4 * 2 * i - 20, 0.0, 255.0), 1.5);
    EXPECT_NEAR(pixel[1], 1.4 * i, 1.5);
  }
}

}  // namespace
}  // namespace alidade::epipolar_search_test
