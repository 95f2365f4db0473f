#include "alidade/tracking/mono_start.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "problems/synthetic_world.h"

namespace alidade::mono_start_test {
namespace {

constexpr SyntheticWorldSettings kWorld{.points = 900,
                                        .cameras = 30,
                                        .step = 0.03,
                                        .turn = 0.004,
                                        .noise_px = 0.5,
                                        .flipped_bits = 12,
                                        .clutter = 150};

struct Start {
  std::optional<MonoStartResult> result;
  std::string reason;  // of the last frame that did not start a map
};

Start FeedAll(const SyntheticWorld& world, MonoStart& start) {
  Start outcome;
  for (const SyntheticView& view : world.views) {
    outcome.result = start.Add(view.frame);
    if (outcome.result) break;
    outcome.reason = ReasonText(start.failure());
  }
  return outcome;
}

TEST(MonoStart, StartsFromAMovingCamera) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    SyntheticWorldSettings settings = kWorld;
    settings.seed = seed;
    const SyntheticWorld world = MakeSyntheticWorld(settings);
    MonoStart start(world.camera, {});
    const Start outcome = FeedAll(world, start);
    ASSERT_TRUE(outcome.result) << outcome.reason;
    const MonoStartResult& result = *outcome.result;
    const SyntheticView &a = world.views[result.a->number], &b = world.views[result.b->number];
    const Se3 truth = b.T_camera_world * a.T_camera_world.Inverse();
    EXPECT_LT(RotationAngle(result.T_b_a, truth), 0.01);
    // At a few degrees of parallax, a lateral translation and a rotation are hardly distinguishable
    // with half a pixel of noise.
    EXPECT_GT(result.T_b_a.t.normalized().dot(truth.t.normalized()), std::cos(0.2));
    int right = 0;
    for (const auto& point : result.points) {
      right += a.points[point.keypoint_a] >= 0 &&
               a.points[point.keypoint_a] == b.points[point.keypoint_b];
    }
    EXPECT_GE(right, 0.98 * static_cast<double>(result.points.size()));
    EXPECT_GT(result.parallax_degrees, 0.5);
  }
}

TEST(MonoStart, RefusesACameraThatOnlyTurns) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    SyntheticWorldSettings settings = kWorld;
    settings.seed = seed;
    SyntheticWorldMaker maker(settings);
    for (int i = 0; i < 20; ++i) {
      const double t = 0.15 * i;
      maker.Look({ExpSo3({0.08 * std::sin(t), 0.25 * std::sin(0.7 * t), 0.05 * std::sin(1.3 * t)}),
                  {0, 0, 0}});
    }
    const SyntheticWorld world = maker.Take();
    MonoStart start(world.camera, {});
    const Start outcome = FeedAll(world, start);
    EXPECT_FALSE(outcome.result) << "seed " << seed << ", frames " << outcome.result->a->number
                                 << " and " << outcome.result->b->number;
  }
}

TEST(MonoStart, WaitsWhileTheCameraStands) {
  SyntheticWorldSettings settings = kWorld;
  settings.step = settings.turn = 0;
  SyntheticWorldMaker maker(settings);
  for (int i = 0; i < 20; ++i) maker.Look({});
  const SyntheticWorld world = maker.Take();
  MonoStart start(world.camera, {});
  const Start outcome = FeedAll(world, start);
  EXPECT_FALSE(outcome.result);
  EXPECT_NE(outcome.reason.find("hardly moves"), std::string::npos) << outcome.reason;
}

TEST(MonoStart, ABadFirstFrameCostsNothing) {
  SyntheticWorld world = MakeSyntheticWorld(kWorld);
  Random random(2);  // like a blurred frame: nothing in it is matched
  auto blurred = std::make_shared<Frame>(*world.views[0].frame);
  for (Descriptor& descriptor : blurred->descriptors) descriptor = RandomDescriptor(random);
  world.views[0].frame = blurred;
  MonoStart start(world.camera, {});
  const Start outcome = FeedAll(world, start);
  ASSERT_TRUE(outcome.result) << outcome.reason;
  EXPECT_GT(outcome.result->a->number, 0);
}

TEST(MonoStart, SaysWhenThereIsTooLittleToSee) {
  SyntheticWorldSettings settings = kWorld;
  settings.points = 80;
  settings.clutter = 0;
  const SyntheticWorld world = MakeSyntheticWorld(settings);
  MonoStart start(world.camera, {});
  const Start outcome = FeedAll(world, start);
  EXPECT_FALSE(outcome.result);
  EXPECT_NE(outcome.reason.find("too few corners"), std::string::npos) << outcome.reason;
}

TEST(MonoStart, StartsTheSameWayTwice) {
  const SyntheticWorld world = MakeSyntheticWorld(kWorld);
  MonoStart one(world.camera, {}), other(world.camera, {});
  const Start a = FeedAll(world, one), b = FeedAll(world, other);
  ASSERT_TRUE(a.result && b.result);
  EXPECT_EQ(a.result->b->number, b.result->b->number);
  EXPECT_EQ(a.result->T_b_a.R, b.result->T_b_a.R);
  EXPECT_EQ(a.result->T_b_a.t, b.result->T_b_a.t);
}

// A stationary camera in front of a moving object: some keypoints move as if the camera did, the
// others do not move.
SyntheticWorld BeforeAStillCamera(double share_still) {
  SyntheticWorld world = MakeSyntheticWorld(kWorld);
  Random random(5);
  std::vector<Eigen::Vector2d> place(kWorld.points);
  std::vector<bool> still(kWorld.points);
  for (size_t p = 0; p < place.size(); ++p) {
    still[p] = random.Uniform(0, 1) < share_still;
    place[p] = {random.Uniform(20, world.camera.width - 20),
                random.Uniform(20, world.camera.height - 20)};
  }
  for (SyntheticView& view : world.views) {
    auto frame = std::make_shared<Frame>(*view.frame);
    for (size_t k = 0; k < frame->keypoints.size(); ++k) {
      const int point = view.points[k];
      if (point < 0 || !still[point]) continue;
      frame->keypoints[k].x = static_cast<float>(place[point].x() + 0.25 * random.Gaussian());
      frame->keypoints[k].y = static_cast<float>(place[point].y() + 0.25 * random.Gaussian());
    }
    frame->grid = KeypointGrid(frame->keypoints, world.camera.width, world.camera.height);
    view.frame = frame;
  }
  return world;
}

TEST(MonoStart, AThingThatMovesBeforeAStillCameraIsNoPlace) {
  const SyntheticWorld world = BeforeAStillCamera(0.25);
  MonoStartSettings unaware;
  unaware.max_still_share = 1;
  MonoStart start(world.camera, {}), fooled(world.camera, unaware);
  const Start outcome = FeedAll(world, start);
  EXPECT_FALSE(outcome.result);
  EXPECT_NE(outcome.reason.find("only an object moves"), std::string::npos) << outcome.reason;
  EXPECT_TRUE(FeedAll(world, fooled).result);  // without the check a wrong map is started
}

TEST(MonoStart, TellsTheReasonOfThePairThatCameNearest) {
  SyntheticWorldSettings settings = kWorld;
  SyntheticWorldMaker maker(settings);
  for (int i = 0; i < 20; ++i) maker.Look({ExpSo3({0, 0.01 * i, 0}), {0, 0, 0}});
  for (int i = 0; i < 2; ++i) maker.Look({ExpSo3({0, 0.2, 0}), {0, 0, 0}});
  const SyntheticWorld world = maker.Take();
  MonoStart start(world.camera, {});
  // The newest reference has no motion; the older ones have a pure rotation.
  EXPECT_NE(FeedAll(world, start).reason.find("too little parallax"), std::string::npos);
}

}  // namespace
}  // namespace alidade::mono_start_test
