#include "alidade/system/frame_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <thread>

#include "alidade/io/trajectory.h"

namespace alidade::frame_log_test {
namespace {

class Dice {
 public:
  explicit Dice(unsigned seed) : random_(seed) {}
  double Real(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  int Whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
  Se3 Pose(double reach = 5) {
    Vector6d xi;
    for (int i = 0; i < 6; ++i) xi[i] = Real(-1, 1) * (i < 3 ? reach : 3);
    return Se3::Exp(xi);
  }

 private:
  std::mt19937 random_;
};

KeyFrameId AddKeyFrame(MapCommit& commit, const Se3& T_camera_world, KeyFrameId parent = {}) {
  KeyFrame keyframe;
  keyframe.frame = std::make_shared<Frame>();
  keyframe.T_camera_world = T_camera_world;
  keyframe.parent = parent;
  return commit.Add(std::move(keyframe));
}

// A map that grows, is corrected in position and scale, and whose keyframes are culled. The poses
// of frames are relative to its keyframes; `plain` holds the same anchors as the log, in a plain
// list.
class Journey {
 public:
  explicit Journey(unsigned seed, const TrajectorySettings& settings = {})
      : log(settings), dice_(seed) {
    Grow();
  }

  void Grow() {
    store.Commit([&](MapCommit& commit) {
      const KeyFrameId parent = alive.empty() ? KeyFrameId{} : alive[Any()];
      alive.push_back(AddKeyFrame(commit, dice_.Pose(), parent));
    });
  }
  void Correct() {
    store.Commit([&](MapCommit& commit) {
      for (KeyFrameId id : alive) {
        if (dice_.Real(0, 1) < 0.5) continue;
        KeyFrame* keyframe = commit.Edit(id);
        keyframe->T_camera_world = dice_.Pose(0.1) * keyframe->T_camera_world;
        keyframe->scale *= dice_.Real(0.8, 1.25);
      }
    });
  }
  void Cull() {
    if (alive.size() < 2) return;
    const size_t i = 1 + Any() % (alive.size() - 1);  // never the first
    store.Commit([&](MapCommit& commit) { commit.Remove(alive[i]); });
    alive.erase(alive.begin() + static_cast<std::ptrdiff_t>(i));
  }
  void Frames(int count) {
    const MapSnapshot map = store.Snapshot();
    for (int i = 0; i < count; ++i) {
      log.Begin(0.1 * log.size());
      const bool lost = dice_.Whole(0, 9) == 0;
      Anchor anchor;
      if (!lost) {
        const Se3 T_camera_world = dice_.Pose();
        anchor = AnchorTo(map.state(), alive[Any()], T_camera_world);
        log.Place(anchor, T_camera_world.Inverse());
        live.push_back(T_camera_world.Inverse());
      } else {
        live.push_back({});
      }
      plain.push_back(anchor);
      log.End();
    }
  }
  void Go(int steps) {
    for (int i = 0; i < steps; ++i) {
      Grow();
      if (i % 3 == 2) Cull();
      if (i % 5 == 4) Correct();
      Frames(dice_.Whole(1, 20));
    }
  }

  MapStore store;
  FrameLog log;
  std::vector<KeyFrameId> alive;
  std::vector<Anchor> plain;
  std::vector<Se3> live;

 private:
  size_t Any() { return static_cast<size_t>(dice_.Whole(0, static_cast<int>(alive.size()) - 1)); }
  Dice dice_;
};

double Difference(const Se3& a, const Se3& b) {
  return std::max((a.R - b.R).cwiseAbs().maxCoeff(), (a.t - b.t).cwiseAbs().maxCoeff());
}

void ExpectSame(const std::vector<FramePose>& a, const std::vector<FramePose>& b, double bound) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].index, b[i].index);
    EXPECT_EQ(a[i].time, b[i].time);
    ASSERT_EQ(a[i].tracked, b[i].tracked) << i;
    EXPECT_EQ(a[i].map, b[i].map);
    EXPECT_LE(Difference(a[i].T_world_camera, b[i].T_world_camera), bound) << i;
    EXPECT_EQ(Difference(a[i].T_world_camera_live, b[i].T_world_camera_live), 0) << i;
  }
}

TEST(FrameLog, GivesThePosesItsKeyFramesGive) {
  Journey journey(1);
  journey.Go(200);
  const MapSnapshot map = journey.store.Snapshot();
  const std::vector<FramePose> trajectory = journey.log.Trajectory(journey.store);
  ASSERT_EQ(trajectory.size(), journey.plain.size());
  ASSERT_GT(trajectory.size(), 1500u);  // several chunks
  Trajectory given, expected;
  for (size_t i = 0; i < trajectory.size(); ++i) {
    const Anchor& anchor = journey.plain[i];
    ASSERT_EQ(trajectory[i].index, static_cast<int>(i));
    ASSERT_EQ(trajectory[i].tracked, anchor.keyframe.valid());
    if (!trajectory[i].tracked) continue;
    const Se3 pose = PoseOf(map.state(), anchor).Inverse();
    EXPECT_LE(Difference(trajectory[i].T_world_camera, pose), 1e-12);
    EXPECT_LE(Difference(trajectory[i].T_world_camera_live, journey.live[i]), 1e-14);
    given.push_back({trajectory[i].time, trajectory[i].T_world_camera_live, ""});
    expected.push_back({trajectory[i].time, journey.live[i], ""});
  }
  EXPECT_EQ(FormatTumTrajectory(given), FormatTumTrajectory(expected));
}

TEST(FrameLog, FramesStayWhereTheyAreWhenTheirCulledKeyFramesAreLeftForLivingOnes) {
  Journey journey(2);
  for (int round = 0; round < 8; ++round) {
    journey.Go(30);
    const std::vector<FramePose> before = journey.log.Trajectory(journey.store);
    const MapSnapshot map = journey.store.Snapshot();
    const std::vector<KeyFrameId> anchors = journey.log.Anchors();
    EXPECT_TRUE(
        std::any_of(anchors.begin(), anchors.end(), [&](KeyFrameId id) { return !map.Find(id); }));
    journey.log.Reanchor(map);
    for (KeyFrameId id : journey.log.Anchors()) EXPECT_NE(map.Find(id), nullptr);
    ExpectSame(journey.log.Trajectory(journey.store), before, 1e-9);
  }
  // Poses follow all later corrections as those of the original anchors.
  const MapSnapshot map = journey.store.Snapshot();
  const std::vector<FramePose> trajectory = journey.log.Trajectory(journey.store);
  for (size_t i = 0; i < trajectory.size(); ++i) {
    if (!trajectory[i].tracked) continue;
    EXPECT_LE(
        Difference(trajectory[i].T_world_camera, PoseOf(map.state(), journey.plain[i]).Inverse()),
        1e-9);
  }
}

TEST(FrameLog, FramesOfADroppedMapHaveNoPoseBeforeAndAfterTheyAreTiedAnew) {
  MapStore store;
  FrameLog log;
  KeyFrameId kept, dropped;
  store.Commit([&](MapCommit& commit) {
    kept = AddKeyFrame(commit, {});
    dropped = AddKeyFrame(commit, {});
  });
  for (int i = 0; i < 4; ++i) {
    log.Begin(i);
    log.Place(AnchorTo(store.Snapshot().state(), i % 2 ? dropped : kept, {}), {});
    log.End();
  }
  store.Commit([&](MapCommit& commit) { commit.Remove(commit.Find(dropped)->map); });
  for (int round = 0; round < 2; ++round) {
    const std::vector<FramePose> trajectory = log.Trajectory(store);
    ASSERT_EQ(trajectory.size(), 4u);
    for (int i = 0; i < 4; ++i) EXPECT_EQ(trajectory[i].tracked, i % 2 == 0);
    log.Reanchor(store.Snapshot());
  }
  EXPECT_THAT(log.Anchors(), testing::ElementsAre(kept));
}

// In memory, and counts.
class CountingStore : public ByteStore {
 public:
  class Kept : public Piece {
   public:
    Kept(CountingStore& store, std::string_view bytes) : store_(store), bytes_(bytes) {
      store_.bytes += bytes_.size();
    }
    ~Kept() override { store_.bytes -= bytes_.size(); }
    void Read(std::span<char> bytes) const override {
      ASSERT_EQ(bytes.size(), bytes_.size());
      std::copy(bytes_.begin(), bytes_.end(), bytes.begin());
    }

   private:
    CountingStore& store_;
    const std::string bytes_;
  };
  std::unique_ptr<const Piece> Put(std::string_view put) override {
    if (full) return nullptr;
    return std::make_unique<Kept>(*this, put);
  }
  bool full = false;
  size_t bytes = 0;
};

TEST(FrameLog, BesideAStoreItGivesTheSameAndMemoryDoesNotGrow) {
  const auto store = std::make_shared<CountingStore>();
  Journey plain(6), stored(6);
  stored.log.KeepIn(store);
  const auto both = [&](const auto& change) {
    change(plain);
    change(stored);
  };
  size_t early = 0;
  for (int round = 0; round < 12; ++round) {
    if (round == 6) early = stored.log.bytes();
    if (round == 10) store->full = true;
    if (round == 11) store->full = false;
    both([&](Journey& journey) {
      journey.Go(100);
      journey.log.Reanchor(journey.store.Snapshot());
      // The first frames are stored by now.
      if (round > 6) journey.log.PlaceLate(round, journey.plain.back());
    });
  }
  ASSERT_GT(stored.log.size(), 10000);
  EXPECT_GT(store->bytes, 4000u * 128);
  EXPECT_LT(stored.log.bytes(), 1.2 * static_cast<double>(early) + 2 * 512 * 128);
  const std::vector<FramePose> whole = plain.log.Trajectory(plain.store);
  ExpectSame(stored.log.Trajectory(stored.store), whole, 0);
  ExpectSame(stored.log.Trajectory(stored.store, 700), {whole.begin() + 700, whole.end()}, 0);
}

TEST(FrameLog, WhatIsLetGoLeavesTheStore) {
  TrajectorySettings settings;
  settings.keep_seconds = 600;  // 6000 frames
  const auto store = std::make_shared<CountingStore>();
  Journey journey(7, settings);
  journey.log.KeepIn(store);
  journey.Go(1200);
  ASSERT_GT(journey.log.size(), 10000);
  EXPECT_GT(store->bytes, 0u);
  EXPECT_LE(store->bytes, (6000u + 2 * 512 - 8 * 512) * 128);
  EXPECT_GE(journey.log.Trajectory(journey.store).size(), 6000u);
}

TEST(FrameLog, AFrameTakesLessThan185Bytes) {  // 20 MB per hour at 30 frames per second
  MapStore store;
  FrameLog log;
  KeyFrameId parent;
  const int frames = 20000;
  for (int i = 0; i < frames; ++i) {
    if (i % 10 == 0)  // three keyframes per second, more than in any of our recordings
      store.Commit([&](MapCommit& commit) { parent = AddKeyFrame(commit, {}, parent); });
    log.Begin(i / 30.0);
    log.Place(AnchorTo(store.Snapshot().state(), parent, {}), {});
    log.End();
  }
  EXPECT_LT(log.bytes() / frames, 185u);
}

TEST(FrameLog, WhatIsOlderThanAskedForIsLetGoAndTheRestStays) {
  TrajectorySettings settings;
  settings.keep_seconds = 60;  // 600 frames
  Journey all(3), some(3, settings);
  all.Go(400);
  some.Go(400);
  const std::vector<FramePose> whole = all.log.Trajectory(all.store);
  const std::vector<FramePose> rest = some.log.Trajectory(some.store);
  ASSERT_EQ(some.log.size(), all.log.size());
  ASSERT_GT(whole.size(), 3000u);
  EXPECT_GE(rest.size(), 600u);
  EXPECT_LE(rest.size(), 600u + 2 * 512u);
  const auto gone = whole.end() - static_cast<std::ptrdiff_t>(rest.size());
  ExpectSame(rest, {gone, whole.end()}, 0);
  EXPECT_EQ(some.log.let_go().frames, gone - whole.begin());
  EXPECT_EQ(some.log.let_go().tracked,
            std::count_if(whole.begin(), gone, [](const FramePose& p) { return p.tracked; }));
  EXPECT_LT(some.log.bytes(), all.log.bytes() / 2);
  EXPECT_LT(some.log.Anchors().size(), all.log.Anchors().size());
  EXPECT_EQ(all.log.let_go().frames, 0);
}

TEST(FrameLog, AfterAGapLongerThanAllThatIsKeptItGoesOn) {
  TrajectorySettings settings;
  settings.keep_seconds = 10;
  FrameLog log(settings);
  MapStore store;
  for (int i = 0; i < 512; ++i) log.Begin(0.1 * i);
  for (int i = 0; i < 3; ++i) log.Begin(1e6 + i);
  log.End();
  EXPECT_EQ(log.Trajectory(store).size(), 3u);
  EXPECT_EQ(log.let_go().frames, 512);
}

TEST(FrameLog, TheEndOfTheTrajectoryCanBeHadAlone) {
  Journey journey(4);
  journey.Go(150);
  const std::vector<FramePose> whole = journey.log.Trajectory(journey.store);
  for (const int since : {-1, 0, 1, 511, 512, 700, static_cast<int>(whole.size()) - 1}) {
    ExpectSame(journey.log.Trajectory(journey.store, since),
               {whole.begin() + std::max(0, since), whole.end()}, 0);
  }
  EXPECT_TRUE(journey.log.Trajectory(journey.store, static_cast<int>(whole.size())).empty());
}

TEST(FrameLog, AFrameIsReadOnceItHasEnded) {
  FrameLog log;
  MapStore store;
  log.Begin(1);
  EXPECT_TRUE(log.Trajectory(store).empty());
  log.End();
  EXPECT_EQ(log.Trajectory(store).size(), 1u);
  log.Begin(2);  // never ended, as after an exception
  log.Begin(3);
  EXPECT_EQ(log.Trajectory(store).size(), 2u);
  EXPECT_FALSE(log.Trajectory(store)[1].tracked);
  EXPECT_EQ(log.size(), 3);
}

TEST(FrameLog, AFrameIsPlacedLate) {
  MapStore store;
  KeyFrameId keyframe;
  store.Commit([&](MapCommit& commit) { keyframe = AddKeyFrame(commit, Se3()); });
  FrameLog log;
  const int frames = 1300;  // two full chunks and an open one
  Dice dice(3);
  std::vector<Se3> placed(frames);
  for (int i = 0; i < frames; ++i) {
    log.Begin(i);
    placed[i] = dice.Pose();
    if (i % 2)
      log.Place(AnchorTo(store.Snapshot().state(), keyframe, placed[i]), placed[i].Inverse());
    log.End();
  }
  // All without a pose but 1299.
  const std::vector<int> late = {0, 512, 600, 1299, 1298};
  const std::vector<FramePose> before = log.Trajectory(store);
  for (int i : late) {
    placed[i] = dice.Pose();
    log.PlaceLate(i, AnchorTo(store.Snapshot().state(), keyframe, placed[i]));
  }
  log.PlaceLate(frames, {});  // no such frame: nothing happens
  const std::vector<FramePose> after = log.Trajectory(store);
  ASSERT_EQ(after.size(), before.size());
  for (int i = 0; i < frames; ++i) {
    const bool was_late = std::find(late.begin(), late.end(), i) != late.end();
    EXPECT_EQ(before[i].tracked, i % 2 == 1);
    ASSERT_EQ(after[i].tracked, before[i].tracked || was_late) << i;
    EXPECT_EQ(after[i].late, was_late && !before[i].tracked) << i;
    if (!after[i].tracked) continue;
    EXPECT_LT((after[i].T_world_camera.t - placed[i].Inverse().t).norm(), 1e-9) << i;
    if (after[i].late) continue;
    EXPECT_EQ(after[i].T_world_camera_live.t, before[i].T_world_camera_live.t);
  }
}

TEST(FrameLog, AnotherThreadReadsWholeTrajectoriesBesideTheWriter) {
  Journey journey(5);
  std::atomic<bool> done{false};
  size_t reads = 0, frames = 0;
  std::thread reader([&] {
    while (!done || frames == 0) {
      const std::vector<FramePose> trajectory = journey.log.Trajectory(journey.store);
      EXPECT_GE(trajectory.size(), frames);
      frames = trajectory.size();
      for (size_t i = 0; i < frames; ++i) ASSERT_EQ(trajectory[i].index, static_cast<int>(i));
      ++reads;
    }
  });
  for (int round = 0; round < 20; ++round) {
    journey.Go(10);
    journey.log.Reanchor(journey.store.Snapshot());
  }
  done = true;
  reader.join();
  EXPECT_GT(reads, 0u);
  EXPECT_LE(frames, journey.plain.size());
}

}  // namespace
}  // namespace alidade::frame_log_test
