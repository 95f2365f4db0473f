// Thresholds: invalid values are reported by name, and each part uses its own thresholds.
#include "alidade/dynamics/belief_settings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "alidade/dynamics/evidence.h"
#include "alidade/dynamics/flow_votes.h"
#include "alidade/dynamics/history.h"
#include "alidade/dynamics/objects.h"
#include "alidade/dynamics/settings.h"
#include "alidade/dynamics/surface_belief.h"
#include "alidade/dynamics/track_belief.h"
#include "support/expect_error.h"
#include "support/vga_camera.h"

namespace alidade::belief_settings_test {
namespace {

TEST(BeliefSettings, WhatCannotBeIsNamedWithItsPartAndItsEnds) {
  using Change = std::function<void(DynamicsSettings&)>;
  const float nan = std::nanf("");
  const std::vector<std::pair<const char*, Change>> cases = {
      {"depth.min_readings must be from 1 to 9", [](auto& s) { s.depth.min_readings = 10; }},
      {"depth.stereo_window must be odd", [](auto& s) { s.depth.stereo_window = 16; }},
      {"depth.tolerance must", [=](auto& s) { s.depth.tolerance = nan; }},
      {"history.older must", [](auto& s) { s.history.older = 0; }},
      {"votes.most_ago must", [](auto& s) { s.votes.most_ago = FlowTracks::kHistory; }},
      {"votes.least_ago must", [](auto& s) { s.votes.least_ago = s.votes.most_ago + 1; }},
      {"votes.depth_noise must", [](auto& s) { s.votes.depth_noise = 1; }},
      {"votes.agreement_tracks must", [](auto& s) { s.votes.agreement_tracks = 7; }},
      {"surfaces.free must be from -10 to 0", [](auto& s) { s.surfaces.free = 0.1f; }},
      {"surfaces.forget must be from 0 to 1", [=](auto& s) { s.surfaces.forget = nan; }},
      {"tracks.stood must", [](auto& s) { s.tracks.stood = -0.1f; }},
      {"objects.rests_share must", [](auto& s) { s.objects.rests_share = 1.5; }},
      {"box.oval must", [](auto& s) { s.box.oval = 0; }},
      {"features.sure must", [=](auto& s) { s.features.sure = nan; }},
      {"landmarks.on_mover must", [](auto& s) { s.landmarks.on_mover = 0.4f; }},
  };
  for (const auto& [complaint, change] : cases) {
    DynamicsSettings settings;
    change(settings);
    EXPECT_THAT(ComplaintAbout(settings), testing::HasSubstr(complaint));
  }
}

TEST(BeliefSettings, ToleranceOfDepthIsASquare) {
  EXPECT_FLOAT_EQ(
      DepthTolerance(3, {.tolerance = 0.1f, .tolerance_linear = 0.02f, .tolerance_square = 0.005f}),
      0.1f + 0.06f + 0.045f);
}

TEST(BeliefSettings, SurfacesEndWhereTheStepIsTooHigh) {
  const std::vector<float> depth = {2, 2.1f};
  EXPECT_FALSE(ApartInDepth(depth, 0, 1, {.surface_step = 0.06f}));
  EXPECT_TRUE(ApartInDepth(depth, 0, 1, {.surface_step = 0.04f}));
}

TEST(BeliefSettings, ACellNeedsSoManyReadings) {
  const Camera camera = MakeVgaCamera();
  const Cells cells(camera);
  cv::Mat depth(camera.height, camera.width, CV_32F, cv::Scalar(2));
  depth.colRange(320, 640) = 0;
  for (int y = 0; y < depth.rows; ++y) {  // a third of the readings in cells on the right
    for (int x = 320; x < depth.cols; ++x) {
      if (std::abs(cells.Centre(cells.At(static_cast<float>(x), 0)).x - static_cast<float>(x)) < 1)
        depth.at<float>(y, x) = 3;
    }
  }
  const int right = cells.At(500, 200), left = cells.At(100, 200);
  EXPECT_EQ(DepthOfCells(cells, camera, depth, {.min_readings = 3})[right], 3);
  EXPECT_EQ(DepthOfCells(cells, camera, depth, {.min_readings = 4})[right], 0);
  EXPECT_EQ(DepthOfCells(cells, camera, depth, {.min_readings = 9})[left], 2);
}

TEST(BeliefSettings, HistoryKeepsWhatItIsTold) {
  History history({.recent = 4, .step = 3, .older = 2});
  for (int number = 0; number < 40; ++number) {
    auto view = std::make_shared<PastView>();
    view->number = number;
    history.Add(view);
  }
  EXPECT_EQ(history.Before(4)->number, 36);
  EXPECT_EQ(history.Before(5), nullptr);
  ASSERT_NE(history.Older(1), nullptr);
  EXPECT_EQ(history.Older(0)->number - history.Older(1)->number, 3);
  EXPECT_EQ(history.Older(2), nullptr);
}

// Several adjacent tracks on the surface of one cell.
class WithTracks : public testing::Test {
 protected:
  WithTracks() {
    for (uint32_t i = 0; i < 10; ++i) {
      FlowTrack track;
      track.id = i;
      track.path = {{300 + 2 * static_cast<float>(i), 200}};
      tracks_.push_back(track);
    }
  }
  Cells cells_{MakeVgaCamera()};
  int here_ = cells_.At(310, 200);
  std::vector<FlowTrack> tracks_;
};

TEST_F(WithTracks, ConsensusIsOfAsManyAsItIsTold) {
  const std::vector<int8_t> votes = {1, 1, 1, 1, 1, 1, 1, 1, 1, -1};  // mean 0.8
  EXPECT_EQ(Consensus(cells_, {}, tracks_, votes, {.consensus = 0.7f})[9], 1);
  EXPECT_EQ(Consensus(cells_, {}, tracks_, votes, {.consensus = 0.9f})[9], 0);
  EXPECT_EQ(Consensus(cells_, {}, tracks_, votes, {.consensus_tracks = 11})[9], 0);
}

TEST_F(WithTracks, TracksAreProvenByAsManyVotesAsItIsTold) {
  const std::vector<int8_t> votes(10, 1);
  for (const auto& [proven, frames] : {std::pair{0.15f, 2}, std::pair{0.35f, 4}}) {
    TrackBelief belief({.stood = 0.1f, .forget = 0, .proven = proven});
    int count = 0;
    do {
      belief.Update(tracks_, votes);
      ++count;
    } while (!belief.Proven(cells_, tracks_)[here_] && count < 100);
    EXPECT_EQ(count, frames);
  }
}

TEST_F(WithTracks, SurfacesHeedWhatFlowIsWorth) {
  const std::vector<float> depth(cells_.count(), 3);
  const std::vector<uint8_t> none(cells_.count(), 0);
  const std::vector<int8_t> votes(10, -1);
  const auto after_one_frame = [&](float flow_moved) {
    SurfaceBelief belief(cells_, {.flow_moved = flow_moved, .spread_rate = 0});
    belief.Update(0, depth, {}, History(), none, none, tracks_, votes);
    return belief.log_odds()[here_];
  };
  EXPECT_FLOAT_EQ(after_one_frame(0), kUnknownStatic);
  EXPECT_NEAR(after_one_frame(-0.01f), kUnknownStatic - 0.1, 1e-5);  // ten tracks
  EXPECT_NEAR(after_one_frame(-0.02f), kUnknownStatic - 0.2, 1e-5);
  EXPECT_FLOAT_EQ(after_one_frame(-5), -kCertainStatic);
}

TEST_F(WithTracks, ObjectsRestByAsMuchAsTheyAreTold) {
  DynamicsSettings settings;
  settings.objects.rested = 0.5f;
  settings.objects.rest_tracks = 10;
  const std::vector<std::string> names = {"person"};
  ObjectTracks objects(settings, names);
  objects.Update(std::vector<Detection>{{0, 0.9f, {290, 190, 60, 60}}}, 0, 0, tracks_);
  ASSERT_EQ(objects.objects().size(), 1u);
  MovingObject& person = objects.objects()[0];
  person.cells = CellsInBox(cells_, person.box);
  objects.JudgeRest(tracks_, std::vector<int8_t>(10, 1), cells_);
  EXPECT_FLOAT_EQ(person.static_log_odds, kObjectStatic + 0.5f);
  tracks_.pop_back();
  objects.JudgeRest(tracks_, std::vector<int8_t>(9, 1), cells_);
  EXPECT_FLOAT_EQ(person.static_log_odds, kObjectStatic + 0.5f);  // too few to decide
}

TEST(BeliefSettings, TheOvalOfABoxHasTheExponentItIsTold) {
  const Cells cells(MakeVgaCamera());
  const cv::Rect2f box(100, 100, 320, 240);
  const auto area = [&](float exponent) {
    return static_cast<double>(CellsInOval(cells, box, {}, {.oval = exponent}).size()) /
           static_cast<double>(CellsInBox(cells, box).size());
  };
  EXPECT_NEAR(area(1), 0.5, 0.05);       // a rhombus
  EXPECT_NEAR(area(2), 0.785, 0.05);     // an ellipse: π / 4
  EXPECT_NEAR(area(100), 0.95, 0.0501);  // the box except its outermost cells
}

}  // namespace
}  // namespace alidade::belief_settings_test
