// Relocalization, several maps that are merged, saved maps that are continued: on small images of a
// furnished room, as from a phone.
#include <gtest/gtest.h>

#include <map>

#include "alidade/base/parallel.h"
#include "alidade/map/map_file.h"
#include "alidade/slam.h"
#include "support/check_map.h"
#include "support/rendered_frames.h"

namespace alidade::maps_test {
namespace {

SlamSettings Phone() {
  SlamSettings settings;
  settings.ApplyProfile("phone");
  settings.sensor = Sensor::kRgbd;
  settings.new_map_frames = 8;  // the tests have few frames, far apart
  return settings;
}

std::vector<int> Steps(int first, int last, int step) {
  std::vector<int> numbers;
  for (int i = first; i <= last; i += step) numbers.push_back(i);
  return numbers;
}

constexpr int kBlack = -1;

// Plays frames of the room, 10 per second, and keeps their results.
class Player {
 public:
  explicit Player(const SlamSettings& settings) : slam(SmallRoom().camera(), settings) {}

  void Play(const std::vector<int>& numbers) {
    for (int number : numbers) {
      const RenderedFrame& frame = SmallRoom().Frame(std::max(number, 0));
      const auto shown = [&](const cv::Mat& image) {
        return number == kBlack ? cv::Mat(cv::Mat::zeros(image.size(), image.type())) : image;
      };
      results.push_back(slam.Track(
          {0.1 * static_cast<double>(played.size()), shown(frame.image), {}, shown(frame.depth)}));
      played.push_back(number);
    }
  }

  // Largest position error of the frames tracked in `map`, meters, and their number. `origin`: the
  // frame whose pose is the map's world frame.
  std::pair<double, int> WorstOf(MapId map, int origin) const {
    std::pair<double, int> worst{0, 0};
    for (const FramePose& pose : slam.Trajectory()) {
      if (!pose.tracked || pose.map != map) continue;
      const Se3 truth = SmallRoom().Pose(origin).Inverse() * SmallRoom().Pose(played[pose.index]);
      worst.first = std::max(worst.first, (pose.T_world_camera.t - truth.t).norm());
      ++worst.second;
    }
    return worst;
  }

  Slam slam;
  std::vector<int> played;
  std::vector<TrackResult> results;
};

TEST(Lost, IsFoundAgainWhenSightReturns) {
  Player player(Phone());
  player.Play(Steps(0, 45, 3));
  player.Play(std::vector<int>(12, kBlack));
  for (size_t i = player.played.size() - 12; i < player.played.size(); ++i)
    EXPECT_EQ(player.results[i].state, TrackState::kLost);
  player.Play(Steps(9, 45, 3));  // another place than where the camera was lost
  EXPECT_EQ(player.results[16 + 12].state, TrackState::kTracking);
  EXPECT_EQ(player.slam.Counts().relocalizations, 1);
  EXPECT_EQ(player.slam.Snapshot().Maps().size(), 1u);
  const auto worst = player.WorstOf(MapId{0}, 0);
  EXPECT_EQ(worst.second, 16 + 13);
  EXPECT_LT(worst.first, 0.05);
}

TEST(Lost, DarknessStartsNoMap) {
  Player player(Phone());
  player.Play(Steps(0, 30, 3));
  player.Play(std::vector<int>(30, kBlack));
  player.Play({30});
  EXPECT_EQ(player.slam.Snapshot().Maps().size(), 1u);
  EXPECT_EQ(player.results.back().state, TrackState::kTracking);
}

// One part of the room, then another without overlap, from which the camera returns to the first.
const Player& CutInTwo(int threads) {
  static std::map<int, std::unique_ptr<Player>> players;
  auto& player = players[threads];
  if (player) return *player;
  SetThreadCount(threads);
  player = std::make_unique<Player>(Phone());
  player->Play(Steps(0, 48, 3));
  player->Play(Steps(330, 640, 6));
  player->slam.Finish();
  SetThreadCount(0);
  return *player;
}

TEST(Maps, WhatNeverOverlapsIsAMapOfItsOwnUntilTheyMeet) {
  const Player& player = CutInTwo(1);
  const size_t cut = Steps(0, 48, 3).size();
  // The camera is lost at the jump; a second map starts one second later.
  for (size_t i = cut; i < cut + 8; ++i) EXPECT_EQ(player.results[i].state, TrackState::kLost);
  EXPECT_EQ(player.results[cut + 15].state, TrackState::kTracking);
  EXPECT_EQ(player.slam.Counts().merges, 1);
  const MapSnapshot map = player.slam.Snapshot();
  ExpectConsistent(map);
  EXPECT_EQ(map.Maps(), std::vector<MapId>{MapId{0}});
  // All frames are in one world, including those from before the merge.
  const auto worst = player.WorstOf(MapId{0}, 0);
  EXPECT_GT(worst.second, 55);
  EXPECT_LT(worst.first, 0.2);  // meters; after a wrong merge it is several
}

// Odometry goes on while one map moves into the other.
TEST(Maps, StepsAreThoseOfTheCameraAlsoWhereMapsMerge) {
  const Player& player = CutInTwo(1);
  int steps = 0;
  for (size_t i = 1; i < player.results.size(); ++i) {
    const std::optional<Se3>& step = player.results[i].T_last_camera;
    if (!step || player.results[i - 1].state != TrackState::kTracking) continue;
    const Se3 truth =
        SmallRoom().Pose(player.played[i - 1]).Inverse() * SmallRoom().Pose(player.played[i]);
    EXPECT_LT((step->t - truth.t).norm(), 0.05) << i;  // meters
    ++steps;
  }
  EXPECT_GT(steps, 55);
}

TEST(Maps, StayApartWhereNothingTiesThem) {
  Player player(Phone());
  player.Play(Steps(0, 48, 3));
  player.Play(Steps(330, 420, 6));
  player.slam.Finish();
  const MapSnapshot map = player.slam.Snapshot();
  ExpectConsistent(map);
  ASSERT_EQ(map.Maps().size(), 2u);
  EXPECT_EQ(player.slam.Counts().merges, 0);
  EXPECT_LT(player.WorstOf(MapId{0}, 0).first, 0.05);
  const int origin = player.played[map.Find(map.KeyFramesOf(MapId{1})[0])->frame->number];
  EXPECT_LT(player.WorstOf(MapId{1}, origin).first, 0.08);
  EXPECT_GE(player.WorstOf(MapId{1}, origin).second, 4);
}

TEST(Maps, AMergeGivesTheSameBytesWithOneAndTwoThreads) {
  EXPECT_TRUE(CutInTwo(1).slam.SaveMap() == CutInTwo(2).slam.SaveMap());
  const auto one = CutInTwo(1).slam.Trajectory(), two = CutInTwo(2).slam.Trajectory();
  ASSERT_EQ(one.size(), two.size());
  for (size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].T_world_camera.t, two[i].T_world_camera.t);
    EXPECT_EQ(one[i].T_world_camera.R, two[i].T_world_camera.R);
  }
}

// How far the workers get between frames varies, but the map is always consistent and no pose is
// wrong.
TEST(Maps, AreSoundInTheThreadedSchedule) {
  SlamSettings settings = Phone();
  settings.threaded = true;
  Player player(settings);
  player.Play(Steps(0, 48, 3));
  player.slam.Finish();
  for (int first = 330; first <= 640; first += 24) {
    player.Play(Steps(first, std::min(first + 23, 640), 6));
    ExpectConsistent(player.slam.Snapshot());
    if (first % 48 == 330 % 48) player.slam.Finish();
  }
  player.slam.Finish();
  ExpectConsistent(player.slam.Snapshot());
  EXPECT_LE(player.slam.Snapshot().Maps().size(), 2u);
  EXPECT_LT(player.WorstOf(MapId{0}, 0).first, 0.5);
}

// The saved map of frames 0 to 48.
const std::string& SavedRoom() {
  static const std::string saved = [] {
    Player player(Phone());
    player.Play(Steps(0, 48, 3));
    player.slam.Finish();
    return player.slam.SaveMap();
  }();
  return saved;
}

TEST(SavedMaps, AreGoneOnWithFromTheFirstFrame) {
  Player player(Phone());
  player.slam.Load(DecodeMap(SavedRoom()));
  const int before = player.slam.Snapshot().keyframe_count();
  player.Play(Steps(36, 45, 3));
  player.Play(Steps(51, 87, 3));
  player.slam.Finish();
  for (const TrackResult& result : player.results) EXPECT_EQ(result.state, TrackState::kTracking);
  const MapSnapshot map = player.slam.Snapshot();
  ExpectConsistent(map);
  EXPECT_EQ(map.Maps().size(), 1u);
  EXPECT_GT(map.keyframe_count(), before);
  EXPECT_LT(player.WorstOf(MapId{0}, 0).first, 0.05);
}

TEST(SavedMaps, WhereNothingIsKnownAMapStartsAtOnceAndLeavesTheOld) {
  Player player(Phone());
  player.slam.Load(DecodeMap(SavedRoom()));
  player.Play(Steps(330, 390, 6));
  EXPECT_EQ(player.slam.Snapshot().Maps().size(), 2u);
}

TEST(SavedMaps, LocalisingLeavesThemAsTheyAre) {
  SlamSettings settings = Phone();
  settings.localize = true;
  Player player(settings);
  player.slam.Load(DecodeMap(SavedRoom()));
  player.Play(Steps(0, 48, 3));
  player.Play({kBlack, kBlack, kBlack});
  player.Play(Steps(330, 390, 6));  // not in the map
  player.Play(Steps(6, 45, 3));
  player.slam.Finish();
  int found = 0;
  for (size_t i = 0; i < player.played.size(); ++i) {
    const bool tracked = player.results[i].state == TrackState::kTracking;
    const bool known = player.played[i] >= 0 && player.played[i] < 300;
    EXPECT_TRUE(known || !tracked) << player.played[i];
    found += tracked;
    EXPECT_FALSE(player.results[i].keyframe);
  }
  EXPECT_EQ(found, 17 + 14);
  EXPECT_LT(player.WorstOf(MapId{0}, 0).first, 0.05);
  const MapSnapshot map = player.slam.Snapshot();
  const SavedMap saved = DecodeMap(SavedRoom());
  EXPECT_EQ(map.keyframe_count(), saved.map.keyframe_count());
  EXPECT_EQ(map.landmark_count(), saved.map.landmark_count());
  EXPECT_EQ(map.corrections(), saved.map.corrections());
  for (KeyFrameId id : map.KeyFrames()) EXPECT_EQ(map.PoseOf(id).t, saved.map.PoseOf(id).t);
  for (LandmarkId id : map.Landmarks())
    EXPECT_EQ(map.Find(id)->p_world, saved.map.Find(id)->p_world);
}

}  // namespace
}  // namespace alidade::maps_test
