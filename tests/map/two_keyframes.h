// The smallest map with a spanning tree, and what tests add to it.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

#include "alidade/map/map_store.h"

namespace alidade {

// A keyframe with `keypoints` keypoints and no landmarks.
inline KeyFrame BareKeyFrame(int keypoints, KeyFrameId parent = {},
                             const Se3& T_camera_world = {}) {
  auto frame = std::make_shared<Frame>();
  frame->keypoints.resize(keypoints);
  frame->descriptors.resize(keypoints);
  KeyFrame keyframe;
  keyframe.frame = std::move(frame);
  keyframe.parent = parent;
  keyframe.T_camera_world = T_camera_world;
  return keyframe;
}

inline Landmark SeenBy(std::vector<Observation> observations) {
  Landmark landmark;
  landmark.p_world = {0, 0, 3};
  landmark.reference = landmark.born = observations.front().keyframe;
  landmark.observations = std::move(observations);
  return landmark;
}

inline double Distance(const Se3& a, const Se3& b) { return (a * b.Inverse()).Log().norm(); }

inline Se3 Sideways(double x) { return {Eigen::Matrix3d::Identity(), {x, 0, 0}}; }

// Keyframe a and its child b; one landmark is seen by both, one by b only.
class TwoKeyframes : public testing::Test {
 protected:
  void SetUp() override {
    store_.Commit([&](MapCommit& commit) {
      a_ = commit.Add(BareKeyFrame(4));
      b_ = commit.Add(BareKeyFrame(4, a_, Sideways(-1)));
      both_ = commit.Add(SeenBy({{a_, 0}, {b_, 1}}));
      in_b_ = commit.Add(SeenBy({{b_, 2}}));
    });
  }
  MapStore store_;
  KeyFrameId a_, b_;
  LandmarkId both_, in_b_;
};

}  // namespace alidade
