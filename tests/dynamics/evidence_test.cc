// Geometric evidence of motion, compared with planes and points computed here.
#include "alidade/dynamics/evidence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "alidade/base/random.h"
#include "support/vga_camera.h"

namespace alidade::evidence_test {
namespace {

Se3 Motion(const Eigen::Vector3d& t, const Eigen::Vector3d& turn) {
  Vector6d xi;
  xi << t, turn;
  Se3 pose = Se3::Exp(xi);
  pose.t = t;
  return pose;
}

// --- Epipolar segments ---

class SegmentTest : public testing::Test {
 protected:
  // Current pixel of the point on the ray at this depth.
  Eigen::Vector2d Now(double depth) const {
    const Eigen::Vector3d p = T_now_then_.R * (depth * ray_) + T_now_then_.t;
    return {camera_.fx * p.x() / p.z() + camera_.cx, camera_.fy * p.y() / p.z() + camera_.cy};
  }
  EpipolarSegment Segment(double nearest, double farthest) const {
    return SegmentOf(camera_, ray_, T_now_then_, std::isinf(farthest) ? 0 : 1 / farthest,
                     1 / nearest);
  }

  Camera camera_ = MakeVgaCamera();
  Eigen::Vector3d ray_{0.1, -0.05, 1};
  Se3 T_now_then_ = Motion({0.1, 0.02, 0.03}, {0.01, -0.02, 0.005});
};

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST_F(SegmentTest, EndsAreWhereTheFarthestAndTheNearestPointAreSeen) {
  const EpipolarSegment segment = Segment(0.8, 5);
  ASSERT_TRUE(segment.in_front);
  EXPECT_LT((segment.from - Now(5)).norm(), 1e-9);
  EXPECT_LT((segment.to - Now(0.8)).norm(), 1e-9);
  // An infinitely distant point is only rotated.
  EXPECT_LT((Segment(0.8, kInfinity).from - Now(1e9)).norm(), 1e-4);
}

TEST_F(SegmentTest, EveryPossibleDepthLiesOnIt) {
  const EpipolarSegment segment = Segment(0.8, kInfinity);
  for (double depth : {0.8, 0.9, 1.3, 2.5, 7.0, 40.0, 1e6})
    EXPECT_LT(DistanceTo(segment, Now(depth)), 1e-4) << depth;
}

TEST_F(SegmentTest, WhatWentAlongTheEpipolarLineIsOffByHowFarItIsBeyondItsEnds) {
  const EpipolarSegment segment = Segment(2, 5);
  EXPECT_NEAR(DistanceTo(segment, Now(0.5)), (Now(0.5) - Now(2)).norm(), 1e-6);
  EXPECT_NEAR(DistanceTo(segment, Now(1e9)), (Now(1e9) - Now(5)).norm(), 1e-4);
  EXPECT_GT(DistanceTo(segment, Now(0.5)), 30);  // pixels
}

TEST_F(SegmentTest, WhatWentAcrossTheEpipolarLineIsOffByHowFar) {
  const EpipolarSegment segment = Segment(1, 5);
  const Eigen::Vector2d along = (Now(1) - Now(5)).normalized(), across(-along.y(), along.x());
  for (double off : {0.0, 1.0, 7.5, -20.0})
    EXPECT_NEAR(DistanceTo(segment, Now(2) + off * across), std::abs(off), 1e-6);
}

TEST_F(SegmentTest, IsAPointWhenTheCameraOnlyTurned) {
  T_now_then_ = Motion(Eigen::Vector3d::Zero(), {0.02, -0.05, 0.01});
  const EpipolarSegment segment = Segment(0.3, kInfinity);
  ASSERT_TRUE(segment.in_front);
  EXPECT_LT((segment.from - segment.to).norm(), 1e-9);
  EXPECT_NEAR(DistanceTo(segment, Now(3)), 0, 1e-9);
  EXPECT_NEAR(DistanceTo(segment, Now(3) + Eigen::Vector2d(3, -4)), 5, 1e-9);
}

TEST_F(SegmentTest, CouldNotBeSeenWhereTheCameraLooksAwayOrHasPassedIt) {
  T_now_then_ = Motion(Eigen::Vector3d::Zero(), {0, 3.1, 0});
  EXPECT_FALSE(Segment(0.5, kInfinity).in_front);
  T_now_then_ = {Eigen::Matrix3d::Identity(), {0, 0, -3}};  // 3 m forward
  EXPECT_FALSE(Segment(0.5, 2).in_front);
  EXPECT_TRUE(Segment(0.5, 4).in_front);
}

TEST_F(SegmentTest, WhatTheCameraPassesIsCutOffButTheRestStays) {
  T_now_then_ = {Eigen::Matrix3d::Identity(), {0.1, 0, -1}};  // passes all points nearer than 1 m
  const EpipolarSegment segment = Segment(0.5, kInfinity);
  ASSERT_TRUE(segment.in_front);
  ASSERT_TRUE(segment.from.allFinite() && segment.to.allFinite());
  for (double depth : {1.1, 1.5, 3.0, 1e6})
    EXPECT_LT(DistanceTo(segment, Now(depth)), 1e-3) << depth;
  EXPECT_GT(DistanceTo(segment, Now(3) + Eigen::Vector2d(0, 60)), 20);
}

// --- Comparison with an earlier view ---

class CompareDepthTest : public testing::Test {
 protected:
  // Depth of a wall across the view at world z. The world is the frame of the earlier camera.
  std::vector<float> Plane(const Se3& T_camera_world, double world_z) const {
    const Se3 T_world_camera = T_camera_world.Inverse();
    std::vector<float> depth(cells_.count(), 0);
    for (int i = 0; i < cells_.count(); ++i) {
      const double along = (T_world_camera.R * cells_.Ray(i)).z();
      const double z = (world_z - T_world_camera.t.z()) / along;
      if (z > 0) depth[i] = static_cast<float>(z);
    }
    return depth;
  }
  // Places a board of this depth in a part of the image.
  void Put(std::vector<float>& depth, const cv::Rect2f& where, float z) const {
    for (int i = 0; i < cells_.count(); ++i) {
      if (where.contains(cells_.Centre(i))) depth[i] = z;
    }
  }
  double Share(const DepthComparison& comparison, Comparison what,
               const cv::Rect2f& where = {0, 0, 640, 480}) const {
    int found = 0, all = 0;
    for (int i = 0; i < cells_.count(); ++i) {
      if (!where.contains(cells_.Centre(i))) continue;
      ++all;
      found += comparison.result[i] == what;
    }
    return static_cast<double>(found) / all;
  }

  Cells cells_{MakeVgaCamera()};
  const cv::Rect2f board_{240, 160, 160, 160}, inside_{256, 176, 128, 128};
};

TEST_F(CompareDepthTest, AWallIsTheSameFromWhereverItIsSeen) {
  PastView past;
  past.depth = Plane(past.T_camera_world, 3);
  for (const Se3& pose : {Se3{}, Motion({0.2, -0.1, 0.15}, {0, 0.05, 0.02}),
                          Motion({-0.1, 0, -0.5}, {0.03, -0.04, 0})}) {
    const std::vector<float> depth = Plane(pose, 3);
    const DepthComparison comparison = CompareDepth(cells_, depth, pose, past);
    EXPECT_EQ(Share(comparison, Comparison::kFree), 0);
    EXPECT_GT(Share(comparison, Comparison::kSame, {120, 100, 400, 280}), 0.999);
    // The matching cell is where the point was in the earlier view.
    for (int i = 0; i < cells_.count(); ++i) {
      if (comparison.result[i] != Comparison::kSame) continue;
      const Eigen::Vector3d world = pose.Inverse() * (depth[i] * cells_.Ray(i));
      const cv::Point2f met = cells_.Centre(comparison.met[i]);
      const double x = 525 * world.x() / world.z() + 319.5, y = 525 * world.y() / world.z() + 239.5;
      ASSERT_LT(std::hypot(x - met.x, y - met.y), 2.2 * cells_.size());
    }
  }
}

TEST_F(CompareDepthTest, WhatStandsWhereOneLookedThroughHasCome) {
  PastView past;
  past.depth = Plane(past.T_camera_world, 3);
  const Se3 pose = Motion({0.05, 0, 0}, {0, 0.02, 0});
  std::vector<float> depth = Plane(pose, 3);
  Put(depth, board_, 1.5f);
  const DepthComparison comparison = CompareDepth(cells_, depth, pose, past);
  EXPECT_EQ(Share(comparison, Comparison::kFree, inside_), 1);
  for (int i = 0; i < cells_.count(); ++i) {
    if (comparison.result[i] == Comparison::kFree) {
      ASSERT_TRUE(board_.contains(cells_.Centre(i)));
      ASSERT_EQ(comparison.met[i], -1);
    }
  }
}

TEST_F(CompareDepthTest, WhatWasHiddenThenIsUnknownAndNotMoved) {
  PastView past;
  past.depth = Plane(past.T_camera_world, 3);
  Put(past.depth, board_, 1.5f);
  const DepthComparison comparison = CompareDepth(cells_, Plane({}, 3), {}, past);
  EXPECT_EQ(Share(comparison, Comparison::kUnknown, inside_), 1);
  EXPECT_EQ(Share(comparison, Comparison::kFree), 0);
}

TEST_F(CompareDepthTest, WhatHasNoReadingNowOrThenIsUnknown) {
  PastView past;
  past.depth = Plane(past.T_camera_world, 3);
  std::vector<float> depth = Plane({}, 3);
  Put(depth, board_, 0);
  EXPECT_EQ(Share(CompareDepth(cells_, depth, {}, past), Comparison::kUnknown, inside_), 1);
  depth = Plane({}, 3);
  Put(past.depth, board_, 0);
  EXPECT_EQ(Share(CompareDepth(cells_, depth, {}, past), Comparison::kUnknown, inside_), 1);
  // A hole is not a place that was seen through, even for a nearer surface.
  Put(depth, board_, 1.5f);
  EXPECT_EQ(Share(CompareDepth(cells_, depth, {}, past), Comparison::kFree, inside_), 0);
}

TEST_F(CompareDepthTest, WhatWasOutOfThePictureIsUnknown) {
  PastView past;
  past.depth = Plane(past.T_camera_world, 3);
  const Se3 pose = Motion(Eigen::Vector3d::Zero(), {0, 1.4, 0});  // radians: outside the view
  const std::vector<float> depth(cells_.count(), 2.0f);
  EXPECT_EQ(Share(CompareDepth(cells_, depth, pose, past), Comparison::kUnknown), 1);
}

TEST_F(CompareDepthTest, NoiseOfTheSensorAndThePoseIsNoMotion) {
  Random random(4);
  PastView past;
  past.depth = Plane(past.T_camera_world, 4);
  std::vector<float> depth = Plane({}, 4);
  for (float& z : past.depth) z += static_cast<float>(0.02 * random.Gaussian());
  for (float& z : depth) z += static_cast<float>(0.02 * random.Gaussian());
  const Se3 wrong = Motion({0.01, 0, 0.02}, {0.002, 0, 0});
  const DepthComparison comparison = CompareDepth(cells_, depth, wrong, past);
  EXPECT_GT(Share(comparison, Comparison::kSame), 0.97);
  EXPECT_EQ(Share(comparison, Comparison::kFree), 0);
}

TEST_F(CompareDepthTest, OutlinesOfWhatStandsStillAreNoMotion) {
  // A board 1.5 m in front of the wall, seen from 10 cm to the side: it covers another part of the
  // wall.
  const auto look = [&](const Se3& pose) {
    const Se3 T_world_camera = pose.Inverse();
    std::vector<float> depth = Plane(pose, 3);
    for (int i = 0; i < cells_.count(); ++i) {
      const Eigen::Vector3d direction = T_world_camera.R * cells_.Ray(i);
      const double z = (1.5 - T_world_camera.t.z()) / direction.z();
      const Eigen::Vector3d p = T_world_camera.t + z * direction;
      if (std::abs(p.x()) < 0.3 && std::abs(p.y()) < 0.2) depth[i] = static_cast<float>(z);
    }
    return depth;
  };
  PastView past;
  past.depth = look({});
  const Se3 pose = Motion({0.1, 0.03, 0}, {0, 0.01, 0});
  const DepthComparison comparison = CompareDepth(cells_, look(pose), pose, past);
  EXPECT_EQ(Share(comparison, Comparison::kFree), 0);
  EXPECT_GT(Share(comparison, Comparison::kSame, {100, 60, 440, 360}), 0.85);
}

// --- Propagation over surfaces ---

class SpreadTest : public testing::Test {
 protected:
  Cells cells_{MakeVgaCamera()};
  std::vector<float> values_ = std::vector<float>(cells_.count(), 0);
  std::vector<float> weights_ = std::vector<float>(cells_.count(), 0);
  int At(int column, int row) const { return row * cells_.columns() + column; }
};

TEST_F(SpreadTest, WhatIsTheSameEverywhereStaysSo) {
  Random random(2);
  std::vector<float> depth(cells_.count());
  for (int i = 0; i < cells_.count(); ++i) {
    depth[i] = random.Uniform() < 0.2 ? 0 : static_cast<float>(random.Uniform(1, 1.3));
    values_[i] = -2.5f;
    weights_[i] = static_cast<float>(random.Uniform(0.01, 1));
  }
  SpreadOverSurfaces(cells_, depth, 0.7f, values_, weights_);
  for (float value : values_) ASSERT_NEAR(value, -2.5f, 1e-4f);
}

TEST_F(SpreadTest, WhatIsKnownOfOneCellReachesItsSurfaceAndFades) {
  const std::vector<float> depth(cells_.count(), 2);
  values_[At(40, 30)] = -3;
  weights_[At(40, 30)] = 1;
  SpreadOverSurfaces(cells_, depth, 0.7f, values_, weights_);
  EXPECT_NEAR(values_[At(46, 33)], -3, 1e-3);  // the only evidence
  for (int off = 1; off < 12; ++off) {
    EXPECT_LT(weights_[At(40 + off, 30)], weights_[At(39 + off, 30)]);
    EXPECT_LT(weights_[At(40 - off, 30)], weights_[At(41 - off, 30)]);
    EXPECT_LT(weights_[At(40, 30 + off)], weights_[At(40, 29 + off)]);
    EXPECT_LT(weights_[At(40, 30 - off)], weights_[At(40, 31 - off)]);
  }
  EXPECT_LT(weights_[At(79, 59)], 0.01f * weights_[At(40, 30)]);
}

TEST_F(SpreadTest, AStepOfDepthIsNotCrossed) {
  std::vector<float> depth(cells_.count(), 3);
  for (int row = 0; row < cells_.rows(); ++row) {
    for (int column = 0; column < 40; ++column) depth[At(column, row)] = 1.5f;
  }
  for (int row = 0; row < cells_.rows(); ++row) {
    values_[At(37, row)] = -4;
    values_[At(42, row)] = 4;
    weights_[At(37, row)] = weights_[At(42, row)] = 1;
  }
  SpreadOverSurfaces(cells_, depth, 0.8f, values_, weights_);
  for (int row = 0; row < cells_.rows(); ++row) {
    EXPECT_NEAR(values_[At(39, row)], -4, 1e-3);
    EXPECT_NEAR(values_[At(40, row)], 4, 1e-3);
  }
  // Without depth the discontinuity is unknown.
  std::vector<float> again(cells_.count(), 0), weights(cells_.count(), 0);
  again[At(37, 30)] = -4;
  weights[At(37, 30)] = 1;
  SpreadOverSurfaces(cells_, {}, 0.8f, again, weights);
  EXPECT_NEAR(again[At(44, 30)], -4, 1e-3);
}

TEST_F(SpreadTest, ASurfaceThatLeansIsOneSurface) {
  std::vector<float> depth(cells_.count());
  for (int i = 0; i < cells_.count(); ++i)  // from 2 m to 4 m across the image: about 1 % per cell
    depth[i] = 2 + 2 * static_cast<float>(i % cells_.columns()) / 79;
  values_[At(30, 30)] = -3;
  weights_[At(30, 30)] = 1;
  SpreadOverSurfaces(cells_, depth, 0.8f, values_, weights_);
  EXPECT_NEAR(values_[At(45, 30)], -3, 1e-3);
  EXPECT_GT(weights_[At(36, 30)], 0);
}

TEST_F(SpreadTest, NothingIsSaidWhereNothingWasHeard) {
  SpreadOverSurfaces(cells_, std::vector<float>(cells_.count(), 2), 0.7f, values_, weights_);
  for (int i = 0; i < cells_.count(); ++i) {
    ASSERT_EQ(values_[i], 0);
    ASSERT_EQ(weights_[i], 0);
  }
}

TEST_F(SpreadTest, ItIsAnAverageAndNeverBeyondWhatWasSaid) {
  Random random(8);
  std::vector<float> depth(cells_.count());
  for (int i = 0; i < cells_.count(); ++i) {
    depth[i] = random.Uniform() < 0.1 ? 0 : static_cast<float>(random.Uniform(2, 2.2));
    values_[i] = static_cast<float>(random.Uniform(-5, 3));
    weights_[i] = static_cast<float>(random.Uniform());
  }
  SpreadOverSurfaces(cells_, depth, 0.6f, values_, weights_);
  for (int i = 0; i < cells_.count(); ++i) {
    ASSERT_GE(values_[i], -5.001f);
    ASSERT_LE(values_[i], 3.001f);
    ASSERT_GE(weights_[i], 0);
    ASSERT_LE(weights_[i], 1.001f);
  }
}

}  // namespace
}  // namespace alidade::evidence_test
