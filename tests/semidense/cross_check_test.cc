#include "alidade/semidense/cross_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "alidade/base/random.h"
#include "support/dense_world.h"

namespace alidade::cross_check_test {
namespace {

// Views with true depth plus noise at every second pixel.
class CrossCheckTest : public testing::Test {
 protected:
  struct Known {
    Se3 T_camera_world;
    std::vector<EdgePixel> edges;
    std::vector<Hypothesis> depth;
    std::vector<float> truth;  // inverse depth
  };

  Known Make(const Eigen::Vector3d& centre, double noise, uint64_t seed) const {
    const DenseView view = world_.Look(CameraAt(centre));
    Random random(seed);
    Known known{view.T_camera_world, {}, {}, {}};
    for (int y = 4; y < view.depth.rows - 4; ++y) {
      for (int x = 4 + y % 2; x < view.depth.cols - 4; x += 2) {
        known.edges.push_back({static_cast<uint16_t>(x), static_cast<uint16_t>(y)});
        known.truth.push_back(1 / view.depth.at<float>(y, x));
        const auto error = static_cast<float>(noise * random.Gaussian());
        known.depth.push_back({known.truth.back() + error, static_cast<float>(noise)});
      }
    }
    return known;
  }
  DepthView Seen(const Known& view, const Known& reference) const {
    return {view.edges, view.depth, view.T_camera_world * reference.T_camera_world.Inverse()};
  }

  const DenseWorld world_;
  const Camera& camera_ = world_.camera();
};

TEST_F(CrossCheckTest, KeepsWhatIsTrueAndBringsItNearerToTheTruth) {
  const Known reference = Make({0, 0, 0}, 0.004, 1);
  const std::vector<Known> others = {Make({0.1, 0, 0}, 0.004, 2), Make({-0.1, 0.05, 0}, 0.004, 3),
                                     Make({0, 0.1, 0.1}, 0.004, 4), Make({0.05, 0, 0}, 0.004, 5)};
  std::vector<DepthView> views;
  for (const Known& other : others) views.push_back(Seen(other, reference));
  const auto checked = CrossCheck(reference.edges, reference.depth, views, camera_, {});
  double before = 0, after = 0;
  int kept = 0;
  for (size_t i = 0; i < checked.size(); ++i) {
    if (!checked[i].known()) continue;
    ++kept;
    before += std::pow(reference.depth[i].inverse_depth - reference.truth[i], 2);
    after += std::pow(checked[i].inverse_depth - reference.truth[i], 2);
  }
  EXPECT_GT(kept, 0.8 * static_cast<double>(checked.size()));
  EXPECT_LT(after, before / 2);
}

TEST_F(CrossCheckTest, RemovesWhatOthersContradict) {
  Known reference = Make({0, 0, 0}, 0.004, 1);
  for (Hypothesis& h : reference.depth) h.inverse_depth *= 1.3f;
  const Known a = Make({0.1, 0, 0}, 0.004, 2), b = Make({-0.1, 0, 0}, 0.004, 3),
              c = Make({0, 0.1, 0}, 0.004, 4);
  const std::vector<DepthView> views = {Seen(a, reference), Seen(b, reference), Seen(c, reference)};
  int kept = 0;
  for (const Hypothesis& h : CrossCheck(reference.edges, reference.depth, views, camera_, {})) {
    kept += h.known();
  }
  EXPECT_LT(kept, 0.02 * static_cast<double>(reference.edges.size()));
}

TEST_F(CrossCheckTest, TwoWitnessesAreNotEnoughWhenThreeAreAskedFor) {
  const Known reference = Make({0, 0, 0}, 0.004, 1);
  const Known a = Make({0.1, 0, 0}, 0.004, 2), b = Make({-0.1, 0, 0}, 0.004, 3);
  const std::vector<DepthView> views = {Seen(a, reference), Seen(b, reference)};
  for (const Hypothesis& h : CrossCheck(reference.edges, reference.depth, views, camera_, {})) {
    EXPECT_FALSE(h.known());
  }
}

}  // namespace
}  // namespace alidade::cross_check_test
