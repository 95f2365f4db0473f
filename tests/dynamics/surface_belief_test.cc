// Belief of surfaces: a wall in front of which a board appears, stays and disappears.
#include "alidade/dynamics/surface_belief.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "support/vga_camera.h"

namespace alidade::surface_belief_test {
namespace {

class SurfaceBeliefTest : public testing::Test {
 protected:
  // A wall at 4 m and a board of 0.8 m at 2 m, at board_x_ meters to the right of the world's
  // center.
  std::vector<float> Look(const Se3& T_camera_world) const {
    const Se3 T_world_camera = T_camera_world.Inverse();
    std::vector<float> depth(cells_.count());
    for (int i = 0; i < cells_.count(); ++i) {
      const Eigen::Vector3d direction = T_world_camera.R * cells_.Ray(i);
      const double to_board = (2 - T_world_camera.t.z()) / direction.z();
      const Eigen::Vector3d p = T_world_camera.t + to_board * direction;
      const bool hit = board_ && std::abs(p.x() - board_x_) < 0.4 && std::abs(p.y()) < 0.4;
      depth[i] = static_cast<float>(hit ? to_board : (4 - T_world_camera.t.z()) / direction.z());
    }
    return depth;
  }
  void Frame() {
    // The camera sways slightly.
    Se3 pose;
    pose.t.x() = 0.05 * std::sin(0.1 * number_);
    const std::vector<float> depth = Look(pose);
    belief_.Carry(depth, pose, history_);
    belief_.Update(number_, depth, pose, history_, resting_, suspect_, {}, {});
    auto view = std::make_shared<PastView>();
    view->number = number_;
    view->T_camera_world = pose;
    view->depth = depth;
    for (int i = 0; i < cells_.count() && blind_; ++i) {
      if (cells_.Centre(i).x < kBlindTo) view->depth[i] = 0;
    }
    view->static_log_odds = belief_.log_odds();
    history_.Add(view);
    ++number_;
    board_x_ += board_step_;
    std::vector<uint8_t> on_board(cells_.count());
    for (int i = 0; i < cells_.count(); ++i) on_board[i] = depth[i] < 2.5f;
    on_board_ = on_board;
  }
  void Frames(int count) {
    for (int i = 0; i < count; ++i) Frame();
  }
  static constexpr float kBlindTo = 325;  // pixels
  // Share of moving cells on the board or on the wall.
  double Moving(bool board) const {
    int all = 0, moving = 0;
    for (int i = 0; i < cells_.count(); ++i) {
      if ((on_board_[i] != 0) != board) continue;
      ++all;
      moving += belief_.log_odds()[i] < 0;
    }
    return static_cast<double>(moving) / all;
  }

  Cells cells_{MakeVgaCamera()};
  SurfaceBelief belief_{cells_};
  History history_;
  std::vector<uint8_t> resting_ = std::vector<uint8_t>(cells_.count(), 0), on_board_;
  std::vector<uint8_t> suspect_ = resting_;  // cells in a detection's box
  bool board_ = false, blind_ = false;       // no depth is measured on the left
  double board_x_ = 0, board_step_ = 0;      // meters, meters per frame
  int number_ = 0;
};

TEST_F(SurfaceBeliefTest, WhatHasAlwaysBeenThereStandsStill) {
  board_ = true;
  for (int i = 0; i < 200; ++i) {
    Frame();
    ASSERT_EQ(Moving(true), 0) << i;
    ASSERT_EQ(Moving(false), 0) << i;
  }
  for (float value : belief_.log_odds()) ASSERT_GT(value, kUnknownStatic - 0.01f);
}

TEST_F(SurfaceBeliefTest, WhatComesMovesWithinASecond) {
  Frames(60);
  board_ = true;
  Frames(25);
  EXPECT_GT(Moving(true), 0.9);
  EXPECT_LT(Moving(false), 0.03);
}

TEST_F(SurfaceBeliefTest, WhatGoesAboutIsFoundWhereverItIs) {
  Frames(60);
  board_ = true;
  board_x_ = -1;
  board_step_ = 0.03;  // 0.9 meters per second
  Frames(15);
  for (int i = 0; i < 40; ++i) {
    Frame();
    ASSERT_GT(Moving(true), 0.8) << i;
    ASSERT_LT(Moving(false), 0.05) << i;
  }
}

TEST_F(SurfaceBeliefTest, WhatComesAndStaysIsPartOfTheRoomInTime) {
  Frames(60);
  board_ = true;
  Frames(25);
  ASSERT_GT(Moving(true), 0.9);
  int frames = 25;
  while (Moving(true) > 0.1 && frames < 600) {
    Frame();
    ++frames;
  }
  EXPECT_LT(frames, 600);  // 20 seconds
  EXPECT_GT(frames, 45);   // not after a short stop
  EXPECT_LT(Moving(false), 0.03);
}

// A board appears; whether its left part was always there is unknown.
class SurfaceBeliefByHearsay : public SurfaceBeliefTest {
 protected:
  // Counts doubted cells and finds the lowest log-odds in the part without evidence of its own,
  // over 25 frames.
  void Come() {
    blind_ = true;
    Frames(60);
    blind_ = false;
    board_ = true;
    for (int i = 0; i < 25; ++i) {
      Frame();
      for (int cell = 0; cell < cells_.count(); ++cell) {
        if (!on_board_[cell]) continue;
        proven_ += cells_.Centre(cell).x > kBlindTo && belief_.log_odds()[cell] < -2;
        if (cells_.Centre(cell).x > kBlindTo - 45) continue;  // the camera sways
        doubted_ += belief_.log_odds()[cell] < 0;
        lowest_ = std::min(lowest_, belief_.log_odds()[cell]);
      }
    }
  }
  int proven_ = 0, doubted_ = 0;
  float lowest_ = 0;
};

TEST_F(SurfaceBeliefByHearsay, IsDoubtedALittle) {
  Come();
  EXPECT_GT(proven_, 500);
  EXPECT_GT(doubted_, 500);
  EXPECT_GE(lowest_, -0.5f);
}

TEST_F(SurfaceBeliefByHearsay, IsBelievedToMoveWhereADetectorSeesSomeone) {
  suspect_.assign(suspect_.size(), 1);
  Come();
  EXPECT_GT(doubted_, 500);
  EXPECT_LT(lowest_, -2);
}

TEST_F(SurfaceBeliefTest, WhatMovesByItselfIsNotPartOfTheRoomForResting) {
  board_ = true;
  Frame();
  resting_ = on_board_;
  for (int i = 0; i < 120; ++i) {
    Frame();
    resting_ = on_board_;
  }
  for (int i = 0; i < cells_.count(); ++i) {
    const cv::Point2f p = cells_.Centre(i);
    const bool deep_inside = std::abs(p.x - 319.5f) < 60 && std::abs(p.y - 239.5f) < 60;
    if (!deep_inside) continue;
    ASSERT_LT(belief_.log_odds()[i], 3);
  }
}

TEST_F(SurfaceBeliefTest, TheWallBehindWhatHasGoneStandsStill) {
  board_ = true;
  Frames(60);
  board_ = false;
  for (int i = 0; i < 60; ++i) {
    Frame();
    ASSERT_LT(Moving(false), 0.03) << i;
  }
}

TEST_F(SurfaceBeliefTest, LogOddsAreBounded) {
  Frames(60);
  board_ = true;
  for (int i = 0; i < 300; ++i) {
    Frame();
    for (float value : belief_.log_odds()) {
      ASSERT_LE(value, kCertainStatic);
      ASSERT_GE(value, -kCertainStatic);
    }
  }
}

}  // namespace
}  // namespace alidade::surface_belief_test
