// Limits on the number of keyframes and on the time that Finish() takes.
#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "alidade/base/log.h"
#include "alidade/base/parallel.h"
#include "alidade/map/map_file.h"
#include "alidade/semidense/semidense_mapper.h"
#include "alidade/slam.h"
#include "alidade/system/workers/workers.h"
#include "support/check_map.h"
#include "support/rendered_frames.h"
#include "support/saved_map.h"

namespace alidade::limits_test {
namespace {

SlamSettings Phone() {
  SlamSettings settings;
  settings.ApplyProfile("phone");
  settings.sensor = Sensor::kRgbd;
  return settings;
}

TrackResult Show(Slam& slam, int number) {
  const RenderedFrame& frame = SmallRoom().Frame(number);
  return slam.Track({number / 30.0, frame.image, {}, frame.depth});
}

class Limits : public testing::Test {
 protected:
  Limits() {
    SetWarningListener([this](const std::string& warning) { warnings_.push_back(warning); });
  }
  ~Limits() override {
    SetWarningListener(nullptr);
    SetThreadCount(0);
  }
  std::vector<std::string> warnings_;
};

TEST_F(Limits, KeyFramesStayWithinTheirsAndTrackingGoesOn) {
  SlamSettings settings = Phone();
  settings.mapper.max_keyframes = 12;
  settings.mapper.redundant_share = 1;  // no keyframe is removed as redundant
  std::string first;
  for (int threads : {1, 2}) {
    SetThreadCount(threads);
    warnings_.clear();
    Slam slam(SmallRoom().camera(), settings);
    int untracked = 0;
    for (int i = 0; i <= 160; i += 4) {
      untracked += Show(slam, i).state != TrackState::kTracking;
      EXPECT_LE(slam.Snapshot().keyframe_count(), 12);
    }
    EXPECT_EQ(untracked, 0);
    ASSERT_EQ(warnings_.size(), 1u);
    EXPECT_NE(warnings_[0].find("mapper.max_keyframes"), std::string::npos);
    const MapSnapshot map = slam.Snapshot();
    EXPECT_GE(map.keyframe_count(), 10);
    EXPECT_GT(map.next_keyframe(), 15u);
    EXPECT_NE(map.Find(KeyFrameId{0}), nullptr);
    ExpectConsistent(map);
    for (const FramePose& pose : slam.Trajectory()) {
      const Se3 truth = SmallRoom().Pose(0).Inverse() * SmallRoom().Pose(4 * pose.index);
      EXPECT_LT((pose.T_world_camera.t - truth.t).norm(), 0.1) << pose.index;
    }
    if (first.empty()) {
      first = slam.SaveMap();
    } else {
      EXPECT_TRUE(first == slam.SaveMap());
    }
  }
}

std::string Poses(const Slam& slam) {
  std::string poses;
  for (const FramePose& pose : slam.Trajectory()) {
    poses.append(reinterpret_cast<const char*>(pose.T_world_camera.t.data()), 3 * sizeof(double));
  }
  return poses;
}

TEST_F(Limits, AFinishThatIsCutShortLeavesTheMapSoundAndTheNextOneDoesTheRest) {
  SlamSettings settings = Phone();
  settings.semidense.enabled = true;
  Slam whole(SmallRoom().camera(), settings), cut(SmallRoom().camera(), settings);
  for (int i = 0; i <= 60; i += 4) {
    Show(whole, i);
    Show(cut, i);
  }
  whole.Finish();
  const std::string before = Poses(cut);
  const int estimated = cut.SemiDense().keyframes;
  cut.CutFinishShort();
  cut.Finish();
  EXPECT_EQ(Poses(cut), before);  // nothing was adjusted
  EXPECT_EQ(cut.SemiDense().keyframes, estimated);
  ExpectConsistent(cut.Snapshot());
  DecodeMap(cut.SaveMap());
  EXPECT_NE(Poses(cut), Poses(whole));
  cut.Finish();
  EXPECT_EQ(Poses(cut), Poses(whole));
  EXPECT_EQ(cut.SemiDense().keyframes, whole.SemiDense().keyframes);
}

// Two parts of the room whose maps are merged, which starts an adjustment.
TEST_F(Limits, ACutBeforeFinishDoesNotDisturbTheRunningMap) {
  SlamSettings settings = Phone();
  settings.new_map_frames = 8;
  Slam whole(SmallRoom().camera(), settings), cut(SmallRoom().camera(), settings);
  cut.CutFinishShort();
  std::vector<int> numbers;
  for (int i = 0; i <= 48; i += 3) numbers.push_back(i);
  for (int i = 330; i <= 640; i += 6) numbers.push_back(i);
  for (size_t i = 0; i < numbers.size(); ++i) {
    const RenderedFrame& frame = SmallRoom().Frame(numbers[i]);
    const FrameInput input{0.1 * static_cast<double>(i), frame.image, {}, frame.depth};
    whole.Track(input);
    cut.Track(input);
  }
  EXPECT_EQ(whole.Counts().merges, 1);
  EXPECT_EQ(cut.Snapshot().corrections(), whole.Snapshot().corrections());
  const std::string before = Poses(cut);
  EXPECT_EQ(before, Poses(whole));
  whole.Finish();
  cut.Finish();
  EXPECT_EQ(Poses(cut), before);
  cut.Finish();
  EXPECT_EQ(Poses(cut), Poses(whole));
}

TEST_F(Limits, ACutEndsOneFinishAndNoOther) {
  Workers workers(SmallRoom().camera(), Phone());
  constexpr double kNoLimit = std::numeric_limits<double>::infinity();
  const auto is_cut = [&](double limit) {
    bool cut = false;
    workers.FinishWithin(limit, [&] {
      workers.Drain();
      cut = workers.cut();
    });
    return cut;
  };
  workers.CutShort();
  EXPECT_FALSE(workers.cut());
  EXPECT_TRUE(is_cut(kNoLimit));
  EXPECT_FALSE(is_cut(kNoLimit));
  workers.FinishWithin(kNoLimit, [&] {
    workers.Drain();
    workers.CutShort();  // too late to have an effect
  });
  EXPECT_FALSE(is_cut(kNoLimit));
  workers.FinishWithin(0, [&] {
    while (!workers.cut()) std::this_thread::yield();
  });
  EXPECT_FALSE(is_cut(kNoLimit));
}

// As after weeks of operation: few objects exist for the number of ids issued. Visiting all ids
// takes ten seconds.
TEST_F(Limits, ACameraIsChangedInAMapOfManyIds) {
  SavedMap saved = MakeSavedMap({.second_map = false, .loops = false, .places = false});
  saved.camera.distortion = {};
  MapState state = saved.map.state();
  state.next_keyframe = state.next_landmark = 0xfffffff0u;
  saved.map = MapSnapshot(std::make_shared<const MapState>(std::move(state)));
  Workers workers(saved.camera, Phone());
  workers.Restore(saved);
  Camera camera = saved.camera;
  camera.fx *= 1.001;
  camera.fy *= 1.001;
  const std::clock_t start = std::clock();
  workers.ChangeCamera(saved.camera, camera);
  EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 4);
  const MapSnapshot map = workers.map().Snapshot();
  ExpectConsistent(map);
  EXPECT_GT(map.landmark_count(), saved.map.landmark_count() / 2);
}

TEST_F(Limits, AFinishWithoutTimeReturnsInTheThreadedSchedule) {
  SlamSettings settings = Phone();
  settings.threaded = true;
  settings.semidense.enabled = true;
  Slam slam(SmallRoom().camera(), settings);
  for (int i = 0; i <= 60; i += 4) Show(slam, i);
  slam.Finish(0);
  ExpectConsistent(slam.Snapshot());
  slam.Finish();
  ExpectConsistent(slam.Snapshot());
}

}  // namespace
}  // namespace alidade::limits_test
