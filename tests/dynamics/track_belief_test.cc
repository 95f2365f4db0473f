// Belief of tracks, vote by vote.
#include "alidade/dynamics/track_belief.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "alidade/dynamics/surface_belief.h"
#include "support/vga_camera.h"

namespace alidade::track_belief_test {
namespace {

class TrackBeliefTest : public testing::Test {
 protected:
  static FlowTrack TrackAt(uint32_t id, float x, float y) {
    FlowTrack track;
    track.id = id;
    track.path = {{x, y}};
    return track;
  }
  float At(float x, float y) const { return belief_.OfCells(cells_, tracks_)[cells_.At(x, y)]; }
  bool ProvenAt(float x, float y) const {
    return belief_.Proven(cells_, tracks_)[cells_.At(x, y)] != 0;
  }
  void Update(const std::vector<int8_t>& votes, int times = 1) {
    for (int i = 0; i < times; ++i) belief_.Update(tracks_, votes);
  }

  Cells cells_{MakeVgaCamera()};
  TrackBelief belief_;
  std::vector<FlowTrack> tracks_ = {TrackAt(1, 100, 100), TrackAt(4, 320, 240),
                                    TrackAt(9, 540, 400)};
};

TEST_F(TrackBeliefTest, NothingIsBelievedBeforeThereIsAVote) {
  Update({0, 0, 0}, 5);
  for (float value : belief_.OfCells(cells_, tracks_)) EXPECT_FLOAT_EQ(value, kUnknownStatic);
  EXPECT_FALSE(ProvenAt(100, 100));
}

TEST_F(TrackBeliefTest, WhatMovesAgainAndAgainIsLeftOutAndWhatStandsIsProven) {
  Update({-1, 1, 0}, 30);
  EXPECT_LT(At(100, 100), 0);
  EXPECT_GT(At(320, 240), kUnknownStatic);
  EXPECT_TRUE(ProvenAt(320, 240));
  EXPECT_FALSE(ProvenAt(100, 100));
  EXPECT_FALSE(ProvenAt(540, 400));
}

TEST_F(TrackBeliefTest, OneVoteIsNotEnough) {
  Update({-1, 1, 0});
  EXPECT_GT(At(100, 100), 0);
  EXPECT_FALSE(ProvenAt(320, 240));
}

TEST_F(TrackBeliefTest, WhatHasComeToRestIsTrustedAgainInTime) {
  Update({-1, 0, 0}, 200);
  ASSERT_LT(At(100, 100), 0);
  int frames = 0;
  while (At(100, 100) < 0 && frames < 1000) {
    Update({1, 0, 0});
    ++frames;
  }
  EXPECT_LT(frames, 300);  // ten seconds
  EXPECT_GT(frames, 5);    // but not immediately
}

TEST_F(TrackBeliefTest, BeliefStaysWithItsTrackWhileOthersComeAndGo) {
  Update({1, -1, 1}, 30);
  tracks_ = {TrackAt(4, 330, 240), TrackAt(9, 540, 400), TrackAt(12, 100, 100)};
  Update({0, 0, 0});
  EXPECT_LT(At(330, 240), 0);
  EXPECT_TRUE(ProvenAt(540, 400));
  EXPECT_FALSE(ProvenAt(100, 100));
  tracks_ = {TrackAt(12, 100, 100)};
  Update({0});
  EXPECT_FLOAT_EQ(At(100, 100), kUnknownStatic);
}

TEST_F(TrackBeliefTest, ThePictureAroundATrackTakesAfterIt) {
  Update({-1, 1, 1}, 30);
  EXPECT_LT(At(108, 100), 0);
  EXPECT_GT(At(530, 390), kUnknownStatic);
}

TEST_F(TrackBeliefTest, NoTracksAreNoTrouble) {
  Update({1, 1, 1}, 3);
  tracks_.clear();
  Update({});
  for (float value : belief_.OfCells(cells_, tracks_)) EXPECT_FLOAT_EQ(value, kUnknownStatic);
}

}  // namespace
}  // namespace alidade::track_belief_test
