// A long stay in one place: memory follows live objects, however many were removed meanwhile.
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "alidade/map/map_file.h"
#include "alidade/slam.h"
#include "support/check_map.h"
#include "support/walked_room.h"

namespace alidade::lasting_test {
namespace {

struct Held {
  uint32_t issued = 0;  // landmark ids
  int alive = 0;        // landmarks and keyframes
  int nodes = 0;        // tree nodes of the id tables
  int left_overs = 0;   // records of culled keyframes and fused landmarks
};

Held HeldBy(const MapSnapshot& map) {
  const MapState& state = map.state();
  return {map.next_landmark(), map.landmark_count() + map.keyframe_count(),
          state.landmarks.tree().CountNodes() + state.keyframes.tree().CountNodes() +
              state.culled.tree().CountNodes(),
          state.culled.size() + static_cast<int>(state.forwards.size())};
}

TEST(Lasting, WhatIsHeldFollowsWhatLives) {
  const WalkedRoom room = WalkRoom({.actors = 0, .frames = 40});
  SlamSettings settings;
  settings.sensor = Sensor::kRgbd;
  settings.tracker.extractor.features = 400;  // for a small image
  settings.tracker.match_scale = settings.mapper.match_scale = settings.start.match_scale = 0.5;
  Slam slam(room.camera, settings);
  cv::RNG noise(5);
  Held early, late;
  int tracked = 0;
  constexpr int kFrames = 1500;
  for (int i = 0; i < kFrames; ++i) {
    const int last = static_cast<int>(room.frames.size()) - 1;
    const int phase = i % (2 * last);
    const RenderedFrame& frame =
        room.frames[static_cast<size_t>(std::min(phase, 2 * last - phase))];
    // Different noise in every frame, so that landmarks are created and removed.
    cv::Mat grain(frame.image.size(), CV_16S), image;
    noise.fill(grain, cv::RNG::NORMAL, 0, 6);
    frame.image.convertTo(image, CV_16S);
    cv::Mat(image + grain).convertTo(image, CV_8U);
    const TrackResult result = slam.Track({i / 30.0, image, {}, frame.depth});
    tracked += result.state == TrackState::kTracking;
    if (i == kFrames / 3) early = HeldBy(slam.Snapshot());
  }
  const MapSnapshot map = slam.Snapshot();
  late = HeldBy(map);
  EXPECT_GT(tracked, kFrames * 9 / 10);
  ExpectConsistent(map);
  ASSERT_GT(late.issued, 2 * early.issued) << "nothing came and went";
  EXPECT_GT(late.issued, 5u * static_cast<uint32_t>(late.alive));
  EXPECT_LT(late.alive, 2 * early.alive);
  EXPECT_LT(late.nodes, late.alive);  // however far apart their ids are
  EXPECT_LT(late.left_overs, late.alive);

  const std::string bytes = slam.SaveMap();
  EXPECT_LT(bytes.size(), static_cast<size_t>(map.keyframe_count()) * 400 * 100 +
                              static_cast<size_t>(map.landmark_count()) * 400 + 200000);
  Slam again(room.camera, settings);
  again.Load(DecodeMap(bytes));
  EXPECT_EQ(again.Snapshot().keyframe_count(), map.keyframe_count());
}

}  // namespace
}  // namespace alidade::lasting_test
