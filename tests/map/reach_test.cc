// Motion gate: maximum distance of an unobserved camera, and the resulting requirement on a place.
#include "alidade/map/reach.h"

#include <gtest/gtest.h>

#include <vector>

#include "problems/synthetic_map.h"

namespace alidade::reach_test {
namespace {

// Positions at 10 Hz along x at `speed` map units per second, ending at time 0 in the origin.
std::vector<TimedPlace> Walk(double speed, double seconds = 3) {
  std::vector<TimedPlace> way;
  for (int i = static_cast<int>(seconds * 10); i >= 0; --i)
    way.push_back({-0.1 * i, {-0.1 * i * speed, 0, 0}});
  return way;
}

constexpr double kDepth = 2;  // map units

double Doubt(const std::vector<TimedPlace>& way, double seconds, double moved, double gone = 0,
             const ReachSettings& settings = {}) {
  return DoubtOf(way, {seconds, {0, moved, 0}}, kDepth, gone, settings);
}

TEST(Reach, IsWhatItsSettingsSay) {
  const ReachSettings settings{
      .speed = 3, .span = 2, .depth_speed = 0.2, .floor = 0.5, .drift = 0.1};
  // 0.5 * 2 + (3 * 1 + 0.2 * 2) * 2 s + 0.1 * 5 = 8.3 map units
  EXPECT_NEAR(Doubt(Walk(1), 2, 8.3 / 2, 5, settings), 0.25, 1e-9);
  EXPECT_NEAR(Doubt(Walk(1), 2, 8.3 / 4, 5, settings), 0.0625, 1e-9);
  EXPECT_EQ(Doubt(Walk(1), 2, 8.4, 5, settings), 1);
  EXPECT_EQ(Doubt(Walk(1), 2, 1000, 5, settings), 1);
  EXPECT_EQ(Doubt(Walk(1), 2, 0, 5, settings), 0);
}

TEST(Reach, GrowsWithTimeSpeedAndTheWay) {
  const double doubt = Doubt(Walk(0.5), 1, 1);
  EXPECT_GT(doubt, 0);
  EXPECT_LT(Doubt(Walk(0.5), 2, 1), doubt);
  EXPECT_LT(Doubt(Walk(1), 1, 1), doubt);
  EXPECT_LT(Doubt(Walk(0.5), 1, 1, 20), doubt);
  EXPECT_GT(Doubt(Walk(0), 1, 1), doubt);
}

TEST(Reach, AsksForTheSpeedJustBefore) {
  std::vector<TimedPlace> stood = Walk(5);
  for (TimedPlace& place : stood) place.time -= 3;
  for (int i = 29; i >= 0; --i) stood.push_back({-0.1 * i, {0, 0, 0}});
  EXPECT_NEAR(Doubt(stood, 1, 0.5), Doubt(Walk(0), 1, 0.5), 1e-9);
  // Ignores a short position error: 5 cm within 1/30 s.
  std::vector<TimedPlace> noisy = Walk(0.5);
  noisy.insert(noisy.end() - 1, {-1 / 30.0, {0, 0.05, 0}});
  EXPECT_NEAR(Doubt(noisy, 1, 1), Doubt(Walk(0.5), 1, 1), 1e-9);
}

TEST(Reach, SaysNothingOfWhatItDoesNotKnow) {
  EXPECT_EQ(Doubt({}, 1, 100), 0);
  EXPECT_EQ(Doubt({{0, {0, 0, 0}}}, 1, 100), 0);
  EXPECT_EQ(Doubt(Walk(1, 0.1), 1, 100), 0);  // too short to estimate the speed
  EXPECT_EQ(Doubt(Walk(1), -0.5, 100), 0);    // clock set back
}

TEST(Reach, RefusesWhatCannotBe) {
  for (const ReachSettings& bad :
       {ReachSettings{.speed = -1}, ReachSettings{.span = 0}, ReachSettings{.depth_speed = -1},
        ReachSettings{.floor = -1}, ReachSettings{.drift = -1}, ReachSettings{.plain_share = 1.1},
        ReachSettings{.plain_alike = -1}, ReachSettings{.elsewhere_share = 2}})
    EXPECT_THROW(bad.Check(), Error);
  EXPECT_NO_THROW(ReachSettings{}.Check());
}

TEST(WayBetween, FollowsTheKeyFramesOfOneMap) {
  const SyntheticWorld world = MakeSyntheticWorld({.points = 300, .cameras = 6});
  MapStore store;
  const SyntheticMap made = FillMap(world, {}, store);
  const auto centre = [&](int view) { return world.views[view].T_camera_world.Inverse().t; };
  double way = 0;
  for (int view = 1; view < 4; ++view) way += (centre(view + 1) - centre(view)).norm();
  const MapSnapshot map = store.Snapshot();
  EXPECT_NEAR(WayBetween(map, made.keyframes[1], made.keyframes[4]), way, 1e-9);
  EXPECT_NEAR(WayBetween(map, made.keyframes[4], made.keyframes[1]), way, 1e-9);
  EXPECT_EQ(WayBetween(map, made.keyframes[2], made.keyframes[2]), 0);
}

}  // namespace
}  // namespace alidade::reach_test
