#include "alidade/semidense/smooth.h"

#include <gtest/gtest.h>

#include <vector>

#include "alidade/base/parallel.h"
#include "alidade/base/random.h"

namespace alidade::smooth_test {
namespace {

constexpr float kChi2 = 5.99f;

// A block of pixels with depth, indexed by position.
struct Block {
  std::vector<EdgePixel> edges;
  std::vector<Hypothesis> depth;
  int width;

  Block(int w, int h) : width(w) {
    for (int y = 1; y <= h; ++y) {
      for (int x = 1; x <= w; ++x) {
        edges.push_back({static_cast<uint16_t>(x), static_cast<uint16_t>(y)});
      }
    }
    depth.resize(edges.size());
  }
  Hypothesis& At(int x, int y) { return depth[(y - 1) * width + x - 1]; }
  std::vector<Hypothesis> Smoothed() const { return Smooth(edges, depth, {40, 40}, kChi2); }
  size_t Index(int x, int y) const { return (y - 1) * width + x - 1; }
};

TEST(Smooth, RemovesWhatStandsAlone) {
  Block block(5, 5);
  block.At(3, 3) = {1.0f, 0.01f};
  block.At(4, 3) = {1.0f, 0.01f};  // one neighbour is not enough
  for (const Hypothesis& h : block.Smoothed()) EXPECT_FALSE(h.known());
}

TEST(Smooth, RemovesWhatItsNeighboursContradict) {
  Block block(5, 5);
  for (Hypothesis& h : block.depth) h = {1.0f, 0.01f};
  block.At(3, 3) = {2.0f, 0.01f};
  const std::vector<Hypothesis> smoothed = block.Smoothed();
  for (const Hypothesis& h : smoothed) {
    ASSERT_TRUE(h.known());  // the hole is filled from its neighbors
    EXPECT_NEAR(h.inverse_depth, 1.0, 1e-6);
  }
}

TEST(Smooth, FillsHolesOnlyBetweenThoseThatAgree) {
  Block block(3, 1);
  block.At(1, 1) = {1.0f, 0.01f};
  block.At(3, 1) = {1.5f, 0.01f};
  EXPECT_FALSE(block.Smoothed()[1].known());
}

TEST(Smooth, LeavesAStepInDepthSharp) {
  Block block(10, 10);
  for (int y = 1; y <= 10; ++y) {
    for (int x = 1; x <= 10; ++x) block.At(x, y) = {x <= 5 ? 1.0f : 0.5f, 0.01f};
  }
  const std::vector<Hypothesis> smoothed = block.Smoothed();
  for (int y = 1; y <= 10; ++y) {
    for (int x = 1; x <= 10; ++x) {
      EXPECT_NEAR(smoothed[block.Index(x, y)].inverse_depth, x <= 5 ? 1.0 : 0.5, 1e-6);
    }
  }
}

TEST(Smooth, TakesNoiseAwayWithOneThreadOrThree) {
  Block block(36, 36);
  Random random(7);
  for (Hypothesis& h : block.depth) {
    h = {static_cast<float>(1 + 0.01 * random.Gaussian()), 0.01f};
  }
  SetThreadCount(1);
  const std::vector<Hypothesis> one = block.Smoothed();
  SetThreadCount(3);
  const std::vector<Hypothesis> three = block.Smoothed();
  SetThreadCount(0);
  double before = 0, after = 0;
  for (size_t i = 0; i < one.size(); ++i) {
    before += (block.depth[i].inverse_depth - 1) * (block.depth[i].inverse_depth - 1);
    after += (one[i].inverse_depth - 1) * (one[i].inverse_depth - 1);
    EXPECT_EQ(one[i].inverse_depth, three[i].inverse_depth);
  }
  // The mean of nine would have a ninth of the variance; outer values have fewer compatible
  // neighbors.
  EXPECT_LT(after, before / 2.5);
}

}  // namespace
}  // namespace alidade::smooth_test
