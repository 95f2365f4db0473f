// What the watch makes of poses of a known motion in maps of known scale; no images.
#include "alidade/system/inertial/inertial_watch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <optional>

#include "support/smooth_motion.h"

namespace alidade::inertial_watch_test {
namespace {

KeyFrameId AddKeyFrame(MapStore& maps, double time, KeyFrameId parent, const Se3& T_camera_world) {
  KeyFrameId id;
  maps.Commit([&](MapCommit& commit) {
    KeyFrame keyframe;
    auto frame = std::make_shared<Frame>();
    frame->time = time;
    keyframe.frame = std::move(frame);
    keyframe.parent = parent;
    keyframe.T_camera_world = T_camera_world;
    id = commit.Add(std::move(keyframe));
  });
  return id;
}

// One keyframe at the origin, to which all poses of a map are relative.
KeyFrameId AddMap(MapStore& maps) { return AddKeyFrame(maps, 0, {}, {}); }

struct Walk {
  explicit Walk(bool may_scale, Sensor sensor = Sensor::kMono) : watch(sensor, may_scale) {}

  // Moves on for `seconds`, or until a map is joined to the one before; the unit of the map is
  // `meters`, its axes are turned by `R_map_world`.
  std::optional<InertialWatch::Join> Go(double seconds, KeyFrameId keyframe, double meters,
                                        const Eigen::Matrix3d& R_map_world) {
    for (const double end = time + seconds; time < end; time += 0.05) {
      std::vector<ImuSample> readings = SmoothMotion::Readings(time, time + 0.0499, 200, {});
      if (dead)
        for (ImuSample& reading : readings) reading = {reading.time};
      for (ImuSample& reading : readings) reading.time += clock;
      if (!(time > silent_from && time < silent_to)) watch.Take(readings);
      Se3 T_map_camera = SmoothMotion::At(time, {}).T_world_imu;
      T_map_camera.R = R_map_world * T_map_camera.R;
      T_map_camera.t = R_map_world * T_map_camera.t / (meters * scaled);
      const MapSnapshot map = maps.Snapshot();
      Matrix6d covariance = 1e-6 * Matrix6d::Identity();
      watch.Placed(time, AnchorTo(map.state(), keyframe, T_map_camera.Inverse()), covariance, map);
      if (auto question = watch.Ask(map)) watch.Answer(AnswerOf(*question));
      const InertialWatch::Changes changes = watch.UseAnswer(map);
      if (changes.join) return changes.join;
      if (const auto& growth = changes.growth) {
        // As Workers::Scale() does: keyframes and what is relative to them grow.
        scaled /= growth->factor;
        maps.Commit([&](MapCommit& commit) { commit.Edit(keyframe)->scale *= growth->factor; });
      }
    }
    return std::nullopt;
  }
  // The camera sees nothing. Returns the pose by dead reckoning at the end.
  std::optional<InertialWatch::Reckoned> GoBlind(double seconds) {
    std::optional<InertialWatch::Reckoned> reckoned;
    for (const double end = time + seconds; time < end; time += 0.05) {
      watch.Take(SmoothMotion::Readings(time, time + 0.0499, 200, {}));
      reckoned = watch.DeadReckoned(time, maps.Snapshot());
    }
    return reckoned;
  }

  MapStore maps;
  InertialWatch watch;
  double time = 0;
  double scaled = 1;  // meters of a map unit, relative to those before any growth
  double silent_from = 0, silent_to = 0;  // times without readings
  bool dead = false;                      // readings are 0
  double clock = 0;                       // added to the stamps of readings, seconds
};

double AngleToGravity(const Walk& walk, const Eigen::Matrix3d& R_map_world) {
  const Eigen::Vector3d down = R_map_world * SmoothMotion::Gravity().normalized();
  return std::acos(std::min(1.0, walk.watch.report().gravity->dot(down)));
}

const Eigen::Matrix3d kTilted = ExpSo3({0.4, -0.2, 0.9}), kOther = ExpSo3({-1.9, 0.3, 0.2});

TEST(InertialWatch, ScalesAMapToMeters) {
  Walk walk(true);
  walk.Go(6, AddMap(walk.maps), 2.5, kTilted);
  ASSERT_TRUE(walk.watch.report().metric) << walk.watch.report().missing;
  EXPECT_NEAR(2.5 * walk.scaled, 1, 0.02);
  EXPECT_LT(AngleToGravity(walk, kTilted), 0.01);
}

TEST(InertialWatch, ReadingsThatCeaseForAWhileAreUsedAfterwards) {
  Walk walk(true);
  walk.silent_from = 2.5;
  walk.silent_to = 5.5;
  walk.Go(10, AddMap(walk.maps), 2.5, kTilted);
  EXPECT_TRUE(walk.watch.report().left_out.empty()) << walk.watch.report().left_out;
  ASSERT_TRUE(walk.watch.report().metric) << walk.watch.report().missing;
  EXPECT_NEAR(2.5 * walk.scaled, 1, 0.02);
  EXPECT_LT(AngleToGravity(walk, kTilted), 0.01);
}

TEST(InertialWatch, DoesNotReckonAcrossASilenceOfTheSensor) {
  Walk walk(true);
  walk.Go(6, AddMap(walk.maps), 2.5, kTilted);
  ASSERT_TRUE(walk.watch.report().metric);
  ASSERT_TRUE(walk.GoBlind(0.2));
  walk.time += 2;
  EXPECT_FALSE(walk.GoBlind(0.2));
}

// Whether a keyframe of `time` gets the motion since one 0.4 s before it.
bool HasMotionAt(Walk& walk, double time, KeyFrameId first) {
  KeyFrameId newest;
  for (const double at : {time - 0.4, time}) {
    const Se3 T_map_camera{kTilted * SmoothMotion::At(at, {}).T_world_imu.R, {}};
    newest = AddKeyFrame(walk.maps, at, first, T_map_camera.Inverse());
  }
  const auto motions = walk.watch.MissingMotions(walk.maps.Snapshot());
  return !motions.empty() && motions.back().first == newest;
}

TEST(InertialWatch, ReadingsThatGoWrongAreNotUsedUntilTheyAgreeAgain) {
  Walk walk(true);
  const KeyFrameId first = AddMap(walk.maps);
  const auto has_motion_after = [&](double before) {
    return HasMotionAt(walk, walk.time - before, first);
  };
  const auto turn_is_known = [&] {
    return walk.watch.TurnBetween(walk.time - 0.1, walk.time - 0.06).has_value();
  };
  const auto is_reckoned = [&] {
    return walk.watch.DeadReckoned(walk.time - 0.02, walk.maps.Snapshot()).has_value();
  };
  walk.Go(6, first, 2.5, kTilted);
  ASSERT_TRUE(walk.watch.report().metric);
  EXPECT_TRUE(has_motion_after(0.6));
  EXPECT_TRUE(turn_is_known());
  EXPECT_TRUE(is_reckoned());
  EXPECT_GT(walk.watch.MotionsHoldUntil(), 1e9);
  walk.dead = true;
  const double wrong_from = walk.time;
  walk.Go(0.2, first, 2.5, kTilted);
  EXPECT_FALSE(has_motion_after(0.1));
  walk.Go(1, first, 2.5, kTilted);
  walk.dead = false;
  EXPECT_FALSE(has_motion_after(0.4));
  EXPECT_NEAR(walk.watch.MotionsHoldUntil(), wrong_from, 0.6);
  EXPECT_FALSE(turn_is_known());
  EXPECT_FALSE(is_reckoned());
  walk.Go(27, first, 2.5, kTilted);
  EXPECT_TRUE(walk.watch.report().left_out.empty()) << walk.watch.report().left_out;
  EXPECT_TRUE(has_motion_after(0.6));
  EXPECT_TRUE(turn_is_known());
  EXPECT_TRUE(is_reckoned());
}

TEST(InertialWatch, ReadingsWhoseClockJumpsAreNotUsed) {
  for (const double jump : {-5.0, -0.5, 1.0}) {
    Walk walk(true);
    const KeyFrameId first = AddMap(walk.maps);
    walk.Go(6, first, 2.5, kTilted);
    ASSERT_TRUE(walk.watch.report().metric);
    walk.clock = jump;
    walk.Go(6.5, first, 2.5, kTilted);
    EXPECT_FALSE(HasMotionAt(walk, 7.2, first)) << jump;
    EXPECT_FALSE(HasMotionAt(walk, 12, first)) << jump;
    EXPECT_FALSE(walk.watch.TurnBetween(walk.time - 0.1, walk.time - 0.06)) << jump;
    EXPECT_FALSE(walk.watch.DeadReckoned(walk.time - 0.02, walk.maps.Snapshot())) << jump;
  }
}

TEST(InertialWatch, BeginsAnewInTheNextMap) {
  Walk walk(true);
  walk.Go(6, AddMap(walk.maps), 2.5, kTilted);
  ASSERT_TRUE(walk.watch.report().metric);
  walk.scaled = 1;
  walk.time += 40;  // longer than dead reckoning holds
  const KeyFrameId next = AddMap(walk.maps);
  walk.Go(0.2, next, 0.3, kOther);
  EXPECT_FALSE(walk.watch.report().metric);
  EXPECT_FALSE(walk.watch.report().gravity);
  EXPECT_FALSE(walk.watch.report().missing.empty());
  walk.Go(6, next, 0.3, kOther);
  ASSERT_TRUE(walk.watch.report().metric) << walk.watch.report().missing;
  EXPECT_NEAR(0.3 * walk.scaled, 1, 0.02);
  EXPECT_LT(AngleToGravity(walk, kOther), 0.01);
}

// Two maps that show nothing in common, with two seconds between them.
TEST(InertialWatch, JoinsAMapToTheOneBeforeByTheMotionBetweenThem) {
  Walk walk(true);
  const KeyFrameId first = AddMap(walk.maps);
  walk.Go(6, first, 2.5, kTilted);
  const double first_unit = 2.5 * walk.scaled;
  const auto reckoned = walk.GoBlind(2);
  ASSERT_TRUE(reckoned);
  const Se3 truth = SmoothMotion::At(reckoned->pose.time, {}).T_world_imu;
  const Eigen::Vector3d there = kTilted * truth.t / first_unit;
  const double sigma = std::sqrt(reckoned->pose.covariance.topLeftCorner<3, 3>().trace());
  EXPECT_LT((reckoned->pose.T_world_camera.t - there).norm(), std::min(0.06, 4 * sigma));
  EXPECT_LT(sigma, 0.12);

  walk.scaled = 1;
  const KeyFrameId second = AddMap(walk.maps);
  const auto join = walk.Go(6, second, 0.3, kOther);
  ASSERT_TRUE(join);
  const MapSnapshot map = walk.maps.Snapshot();
  EXPECT_EQ(join->older, map.MapOf(first));
  EXPECT_EQ(join->younger, map.MapOf(second));
  EXPECT_EQ(join->anchor, first);
  EXPECT_NEAR(join->T_older_younger.s * first_unit / (0.3 * walk.scaled), 1, 0.02);
  const Eigen::Matrix3d R = kTilted * kOther.transpose();
  EXPECT_LT(RotationAngle(Se3{join->T_older_younger.R, {}}, Se3{R, {}}), 0.01);
  EXPECT_LT(join->T_older_younger.t.norm() * first_unit, 0.06);  // both have the same origin
  EXPECT_TRUE(walk.watch.report().metric);
  EXPECT_LT(AngleToGravity(walk, kTilted), 0.01);
}

TEST(InertialWatch, DoesNotJoinMapsAfterHalfAMinute) {
  Walk walk(true);
  walk.Go(6, AddMap(walk.maps), 2.5, kTilted);
  EXPECT_FALSE(walk.GoBlind(40));
  walk.scaled = 1;
  EXPECT_FALSE(walk.Go(6, AddMap(walk.maps), 0.3, kOther));
}

TEST(InertialWatch, DoesNotCallAMapMetricThatItMustNotScale) {
  Walk other(false);
  other.Go(6, AddMap(other.maps), 2.5, kTilted);
  EXPECT_FALSE(other.watch.report().metric);
  EXPECT_NE(other.watch.report().missing.find("another unit"), std::string::npos);
  Walk meters(false);
  meters.Go(6, AddMap(meters.maps), 1, kTilted);
  EXPECT_TRUE(meters.watch.report().metric);
}

TEST(InertialWatch, TellsThatAStereoPairHasOtherLengths) {
  Walk walk(true, Sensor::kStereo);
  walk.Go(6, AddMap(walk.maps), 1.05, kTilted);
  EXPECT_FALSE(walk.watch.report().metric);
  EXPECT_NE(walk.watch.report().missing.find("% longer than by the stereo pair"), std::string::npos)
      << walk.watch.report().missing;
  EXPECT_EQ(walk.scaled, 1);
}

TEST(InertialWatch, GoesOnWhenTheClockIsSetBack) {
  Walk walk(true);
  walk.time = 1000;
  walk.Go(3, AddMap(walk.maps), 2.5, kTilted);
  walk.time = 0;
  walk.scaled = 1;
  walk.watch.Cut();
  walk.Go(6, AddMap(walk.maps), 2.5, kTilted);
  EXPECT_TRUE(walk.watch.report().metric) << walk.watch.report().missing;
}

}  // namespace
}  // namespace alidade::inertial_watch_test
