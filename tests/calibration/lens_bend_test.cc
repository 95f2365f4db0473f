#include "alidade/calibration/lens_bend.h"

#include <gtest/gtest.h>

#include <cmath>

#include "problems/bundle_problem.h"

namespace alidade {
namespace {

struct Seen {
  double k1 = 0;     // of the true lens
  double focal = 1;  // of the true lens, relative to that of the problem's camera
  BundleScene scene = BundleScene::kRoom;
  double stereo = 0;
  uint64_t seed = 1;
};

// Adjusted as if the problem's camera were correct.
std::optional<LensBend> BendOf(const Seen& seen) {
  BundleProblem problem = MakeBundleProblem({.scene = seen.scene,
                                             .fixed_cameras = 2,
                                             .free_cameras = 8,
                                             .points = 500,
                                             .min_track = 3,
                                             .stereo = seen.stereo,
                                             .noise_px = 0.7,
                                             .seed = seen.seed});
  Camera lens = problem.camera;
  lens.distortion = {seen.k1, 0, 0, 0, 0};
  for (BundleObservation& o : problem.observations) {
    const Eigen::Vector2d middle(lens.cx, lens.cy);
    const Eigen::Vector2d ideal = o.pixel.head<2>();
    const Eigen::Vector2d bent = middle + seen.focal * (lens.Distort(ideal) - middle);
    o.pixel.z() += bent.x() - ideal.x();  // the disparity is that of a rectified pair
    o.pixel.head<2>() = bent;
  }
  problem.fixed.assign(problem.fixed.size(), 0);
  problem.fixed[0] = 1;
  AdjustBundle(problem, {.max_iterations = 30});
  return EstimateLensBend(problem);
}

TEST(LensBend, FindsABentLensBehindAnAdjustedBundle) {
  for (double k1 : {-0.25, -0.1, 0.1, 0.25}) {
    for (uint64_t seed : {1, 2, 3}) {
      const auto bend = BendOf({.k1 = k1, .seed = seed});
      ASSERT_TRUE(bend);
      EXPECT_NEAR(bend->k1, k1, 0.25 * std::abs(k1) + 0.02) << "seed " << seed;
      EXPECT_GT(std::abs(bend->k1), 5 * bend->sigma);
    }
  }
}

TEST(LensBend, TakesNoiseForNone) {
  for (uint64_t seed = 1; seed <= 8; ++seed) {
    const auto bend = BendOf({.seed = seed});
    ASSERT_TRUE(bend);
    EXPECT_LT(std::abs(bend->k1), 0.02) << "seed " << seed;
    EXPECT_LT(std::abs(bend->k1), 4 * bend->sigma) << "seed " << seed;
  }
}

// For a rotating camera a wrong focal length has an effect similar to radial distortion.
TEST(LensBend, KeepsAWrongFocalLengthApart) {
  for (double focal : {0.85, 1.15}) {
    for (BundleScene scene : {BundleScene::kRoom, BundleScene::kTurning}) {
      const auto bend = BendOf({.focal = focal, .scene = scene});
      ASSERT_TRUE(bend);
      EXPECT_LT(std::abs(bend->k1), 0.06) << focal;
    }
  }
}

TEST(LensBend, UsesDisparitiesWhereTheyAre) {
  const auto bend = BendOf({.k1 = -0.2, .stereo = 1});
  ASSERT_TRUE(bend);
  EXPECT_NEAR(bend->k1, -0.2, 0.05);
}

TEST(LensBend, SaysNothingOfTooLittle) {
  EXPECT_FALSE(EstimateLensBend({}));
  BundleProblem problem = MakeBundleProblem({.fixed_cameras = 1, .free_cameras = 2, .points = 3});
  EXPECT_FALSE(EstimateLensBend(problem));
}

}  // namespace
}  // namespace alidade
