#include "alidade/semidense/landmark_agreement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "problems/synthetic_map.h"

namespace alidade::landmark_agreement_test {
namespace {

// A keyframe with semi-dense depth one pixel beside each landmark's keypoint.
class LandmarkAgreement : public testing::Test {
 protected:
  LandmarkAgreement() : world_(MakeSyntheticWorld({.points = 300, .cameras = 4})) {
    id_ = FillMap(world_, {}, store_).keyframes[1];
    const MapSnapshot map = store_.Snapshot();
    const KeyFrame& keyframe = *map.Find(id_);
    for (size_t i = 0; i < keyframe.landmarks.size(); ++i) {
      if (!keyframe.landmarks[i].valid()) continue;
      const Keypoint& keypoint = keyframe.frame->keypoints[i];
      const auto x = static_cast<uint16_t>(std::lround(keypoint.x) + 1);
      if (x >= world_.camera.width) continue;
      edges_.push_back({x, static_cast<uint16_t>(std::lround(keypoint.y))});
      const Eigen::Vector3d p = keyframe.T_camera_world * map.Find(keyframe.landmarks[i])->p_world;
      depth_.push_back({static_cast<float>(1 / p.z()), 0.01f});
    }
  }
  // Multiplies the depth of edge i by factor(i); 0: unknown.
  bool Agrees(const std::function<double(size_t)>& factor) const {
    std::vector<Hypothesis> depth = depth_;
    for (size_t i = 0; i < depth.size(); ++i) {
      if (factor(i) == 0) depth[i] = {};
      depth[i].inverse_depth /= static_cast<float>(factor(i) == 0 ? 1 : factor(i));
    }
    const MapSnapshot map = store_.Snapshot();
    return AgreesWithLandmarks(map, *map.Find(id_), edges_, depth, world_.camera, 0.05);
  }

  SyntheticWorld world_;
  MapStore store_;
  KeyFrameId id_;
  std::vector<EdgePixel> edges_;
  std::vector<Hypothesis> depth_;
};

TEST_F(LandmarkAgreement, HoldsWhereDepthIsRight) {
  ASSERT_GT(edges_.size(), 50u);
  EXPECT_TRUE(Agrees([](size_t) { return 1.0; }));
  EXPECT_TRUE(Agrees([](size_t i) { return i % 2 ? 0.98 : 1.02; }));
}

TEST_F(LandmarkAgreement, HoldsWithOneWrongInFive) {
  EXPECT_TRUE(Agrees([](size_t i) { return i % 5 == 0 ? 0.5 : 1.0; }));
}

TEST_F(LandmarkAgreement, DoesNotHoldWhereDepthContradictsManyLandmarks) {
  EXPECT_FALSE(Agrees([](size_t i) { return i % 3 == 0 ? 0.5 : 1.0; }));
  EXPECT_FALSE(Agrees([](size_t) { return 0.8; }));
}

TEST_F(LandmarkAgreement, DoesNotHoldByTooFewLandmarks) {
  EXPECT_FALSE(Agrees([](size_t) { return 0.0; }));
  EXPECT_FALSE(Agrees([](size_t i) { return i < 5 ? 1.0 : 0.0; }));
}

}  // namespace
}  // namespace alidade::landmark_agreement_test
