#include "alidade/semidense/packed_depth.h"

#include <gtest/gtest.h>

#include <cmath>

#include "alidade/base/random.h"

namespace alidade::packed_depth_test {
namespace {

TEST(PackedDepth, LosesLittle) {
  Random random(3);
  std::vector<Hypothesis> depth;
  for (int i = 0; i < 1000; ++i) {
    const auto inverse = static_cast<float>(random.Uniform(0.1, 2.0));
    depth.push_back({inverse, static_cast<float>(0.01 * inverse * random.Uniform(0.1, 1))});
  }
  depth[17] = {};
  const std::vector<Hypothesis> back = PackedDepth(depth).Unpack(2);
  ASSERT_EQ(back.size(), depth.size());
  for (size_t i = 0; i < depth.size(); ++i) {
    EXPECT_EQ(back[i].known(), i != 17);
    EXPECT_NEAR(back[i].inverse_depth, 2 * depth[i].inverse_depth, 2 * 2.0 / 65535);
    EXPECT_NEAR(back[i].sigma, 2 * depth[i].sigma, 0.005 * 2 * depth[i].sigma);
  }
}

TEST(PackedDepth, KeepsWhatIsFarAndCertainKnown) {
  const std::vector<Hypothesis> depth = {{5.0f, 1e-3f}, {1e-6f, 1e-9f}};
  const std::vector<Hypothesis> back = PackedDepth(depth).Unpack();
  EXPECT_TRUE(back[1].known());
  EXPECT_GT(back[1].inverse_depth, 0);
}

TEST(PackedDepth, OfNothingIsNothing) {
  EXPECT_TRUE(PackedDepth().Unpack().empty());
  const std::vector<Hypothesis> none(5);
  for (const Hypothesis& h : PackedDepth(none).Unpack()) EXPECT_FALSE(h.known());
}

}  // namespace
}  // namespace alidade::packed_depth_test
