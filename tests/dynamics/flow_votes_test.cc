// Classification of tracks with known motion.
#include "alidade/dynamics/flow_votes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/followed_points.h"

namespace alidade::flow_votes_test {
namespace {

constexpr double kNearest = 0.5;  // meters

std::vector<int8_t> ByPose(const FollowedPoints& made) {
  return VoteByPose(made.camera, Cells(made.camera), made.tracks, made.T_camera_world, made.history,
                    kNearest);
}

Se3 Turned(double angle) {
  Vector6d xi = Vector6d::Zero();
  xi[4] = angle;
  return Se3::Exp(xi);
}

class VotesByPose : public testing::TestWithParam<bool> {  // parameter: with depth
 protected:
  VotesByPose() { settings_.depth = GetParam(); }
  FollowedSettings settings_;
};

TEST_P(VotesByPose, FindWhatMovesAcrossAndNothingElse) {
  // The camera moves right and the board down: across its epipolar lines.
  settings_.board = [](int frame) { return Eigen::Vector3d(0, -0.2 + 0.02 * frame, 2); };
  const FollowedPoints made = FollowPoints(settings_);
  const std::vector<int8_t> votes = ByPose(made);
  EXPECT_GT(ShareOf(made, votes, true, -1), 0.95);
  EXPECT_GT(ShareOf(made, votes, false, 1), 0.95);
  EXPECT_EQ(ShareOf(made, votes, false, -1), 0);
}

TEST_P(VotesByPose, FindWhatOvertakesTheCamera) {
  // Along the epipolar lines, but opposite to the static points' motion in the image.
  settings_.board = [](int frame) { return Eigen::Vector3d(-0.2 + 0.03 * frame, 0, 2); };
  const FollowedPoints made = FollowPoints(settings_);
  const std::vector<int8_t> votes = ByPose(made);
  EXPECT_GT(ShareOf(made, votes, true, -1), 0.95);
  EXPECT_EQ(ShareOf(made, votes, false, -1), 0);
}

TEST_P(VotesByPose, NothingMovesWhereNothingDoes) {
  settings_.moving = 0;
  for (const auto& way : std::vector<std::function<Se3(int)>>{
           [](int) { return Se3{}; }, [](int frame) { return Turned(0.01 * frame); },
           [](int frame) {
             return Se3{Eigen::Matrix3d::Identity(), {0, 0, -0.03 * frame}};
           },
           [](int frame) {
             Se3 pose = Turned(-0.004 * frame);
             pose.t = {0.01 * frame, 0, 0.01 * frame};
             return pose;
           }}) {
    settings_.T_camera_world = way;
    const FollowedPoints made = FollowPoints(settings_);
    const std::vector<int8_t> votes = ByPose(made);
    ASSERT_GT(votes.size(), 60u);
    EXPECT_EQ(ShareOf(made, votes, false, -1), 0);
    EXPECT_GT(ShareOf(made, votes, false, 1), 0.9);
  }
}

TEST_P(VotesByPose, FindWhatMovesWhileTheCameraStandsOrOnlyTurns) {
  for (double turn : {0.0, 0.004}) {
    settings_.T_camera_world = [turn](int frame) { return Turned(turn * frame); };
    const FollowedPoints made = FollowPoints(settings_);
    const std::vector<int8_t> votes = ByPose(made);
    EXPECT_GT(ShareOf(made, votes, true, -1), 0.95) << turn;
    EXPECT_EQ(ShareOf(made, votes, false, -1), 0) << turn;
  }
}

TEST_P(VotesByPose, SayNothingWithoutAnEarlierPose) {
  FollowedPoints made = FollowPoints(settings_);
  made.history.Clear();
  for (int8_t vote : ByPose(made)) EXPECT_EQ(vote, 0);
}

TEST_P(VotesByPose, SayNothingOfATrackThatHasJustBegun) {
  settings_.frames = 2;
  for (int8_t vote : ByPose(FollowPoints(settings_))) EXPECT_EQ(vote, 0);
}

TEST_P(VotesByPose, FramesWithoutAPoseArePassedOver) {
  FollowedPoints made = FollowPoints(settings_);
  const std::vector<int8_t> all = ByPose(made);
  History gaps;
  for (int ago = 15; ago >= 1; --ago) {
    const PastView* view = made.history.Before(ago);
    gaps.Add(ago % 3 == 1 ? nullptr : std::make_shared<PastView>(*view));
  }
  made.history = gaps;
  const std::vector<int8_t> votes = ByPose(made);
  EXPECT_GT(ShareOf(made, votes, true, -1), 0.9);
  EXPECT_EQ(ShareOf(made, votes, false, -1), 0);
}

INSTANTIATE_TEST_SUITE_P(Depth, VotesByPose, testing::Bool(),
                         [](const auto& which) { return which.param ? "WithDepth" : "Without"; });

TEST(VotesByPoseAndDepth, FindWhatMovesAlongTheEpipolarLineAsSomethingNearerWould) {
  // The camera moves right and slightly up; an object moving left and slightly down looks like a
  // nearer static one.
  FollowedSettings settings;
  settings.board = [](int frame) { return Eigen::Vector3d(0.2 - 0.02 * frame, 0.004 * frame, 2); };
  const FollowedPoints without = FollowPoints(settings);
  EXPECT_EQ(ShareOf(without, ByPose(without), true, -1), 0);  // it may be static
  settings.depth = true;
  const FollowedPoints made = FollowPoints(settings);
  const std::vector<int8_t> votes = ByPose(made);
  EXPECT_GT(ShareOf(made, votes, true, -1), 0.9);
  EXPECT_EQ(ShareOf(made, votes, false, -1), 0);
}

TEST(VotesByPoseAndDepth, FindWhatComesTowardsTheCamera) {
  FollowedSettings settings;
  settings.depth = true;
  settings.T_camera_world = [](int frame) {  // forward motion
    return Se3{Eigen::Matrix3d::Identity(), {0, 0, -0.01 * frame}};
  };
  settings.board = [](int frame) { return Eigen::Vector3d(-0.5, 0.3, 2 - 0.05 * frame); };
  const FollowedPoints made = FollowPoints(settings);
  const std::vector<int8_t> votes = ByPose(made);
  EXPECT_GT(ShareOf(made, votes, true, -1), 0.9);
  EXPECT_EQ(ShareOf(made, votes, false, -1), 0);
}

class RivalMotion : public testing::Test {
 protected:
  RivalMotion() {
    settings_.scattered = true;
    settings_.moving = 200;
    settings_.board = [](int frame) { return Eigen::Vector3d(-0.3, -0.2 + 0.02 * frame, 1.5); };
  }
  double Share(const FollowedPoints& made) const {
    return ShareOfRivalMotion(made.camera, Cells(made.camera), made.tracks, ByPose(made), 3);
  }
  // The same with poses relative to the board instead of the world.
  FollowedPoints Following() const {
    FollowedPoints made = FollowPoints(settings_);
    const auto pose = [&](int frame) {
      return settings_.T_camera_world(frame) *
             Se3{Eigen::Matrix3d::Identity(), settings_.board(frame)};
    };
    made.history.Clear();
    for (int frame = 0; frame + 1 < settings_.frames; ++frame) {
      auto view = std::make_shared<PastView>();
      view->number = frame;
      view->T_camera_world = pose(frame);
      made.history.Add(view);
    }
    made.T_camera_world = pose(settings_.frames - 1);
    return made;
  }
  FollowedSettings settings_;
};

TEST_F(RivalMotion, IsTheRoomsWhenThePoseFollowsAMover) {
  const FollowedPoints made = Following();
  ASSERT_GT(ShareOf(made, ByPose(made), true, 1), 0.9);
  ASSERT_GT(ShareOf(made, ByPose(made), false, -1), 0.9);
  EXPECT_GT(Share(made), 0.6);
}

TEST_F(RivalMotion, IsLittleWhenOneMoverHasHalfOfTheCorners) {
  const FollowedPoints made = FollowPoints(settings_);
  ASSERT_GT(ShareOf(made, ByPose(made), true, -1), 0.9);
  EXPECT_LT(Share(made), 0.4);
}

TEST_F(RivalMotion, IsNoneWhereAllElseMovesEachForItself) {
  FollowedPoints made = Following();
  Random random(5);
  for (size_t i = 0; i < made.tracks.size(); ++i) {
    if (made.moves[i]) continue;
    const float angle = static_cast<float>(random.Uniform(-3.14, 3.14));
    for (size_t frame = 0; frame < made.tracks[i].path.size(); ++frame)
      made.tracks[i].path[frame] +=
          static_cast<float>(frame) * cv::Point2f(3 * std::cos(angle), 3 * std::sin(angle));
  }
  EXPECT_EQ(Share(made), 0);
}

TEST_F(RivalMotion, IsNotToldOfAFewTracks) {
  settings_.standing = 30;
  settings_.moving = 30;
  EXPECT_EQ(Share(Following()), 0);
}

class VotesByAgreement : public testing::Test {
 protected:
  VotesByAgreement() { settings_.scattered = true; }
  std::vector<int8_t> Vote(const FollowedPoints& made, uint64_t seed = 3) {
    left_out_.resize(made.tracks.size(), 0);
    return VoteByAgreement(made.camera, made.tracks, left_out_, seed);
  }
  FollowedSettings settings_;
  std::vector<uint8_t> left_out_;
};

TEST_F(VotesByAgreement, TheMinorityIsWhatMoves) {
  settings_.board = [](int frame) { return Eigen::Vector3d(0, -0.2 + 0.02 * frame, 2); };
  const FollowedPoints made = FollowPoints(settings_);
  const std::vector<int8_t> votes = Vote(made);
  EXPECT_GT(ShareOf(made, votes, true, -1), 0.9);
  EXPECT_GT(ShareOf(made, votes, false, 1), 0.9);
}

TEST_F(VotesByAgreement, ACameraThatOnlyTurnsMakesNothingMove) {
  settings_.T_camera_world = [](int frame) { return Turned(0.006 * frame); };
  settings_.moving = 0;
  const FollowedPoints still = FollowPoints(settings_);
  EXPECT_LT(ShareOf(still, Vote(still), false, -1), 0.05);
  settings_.moving = 12;  // more might be explained by parallax
  left_out_.clear();
  const FollowedPoints made = FollowPoints(settings_);
  const std::vector<int8_t> votes = Vote(made);
  EXPECT_GT(ShareOf(made, votes, true, -1), 0.9);
  EXPECT_LT(ShareOf(made, votes, false, -1), 0.05);
}

TEST_F(VotesByAgreement, WhatIsLeftOutHasNoVoteAndNoSay) {
  settings_.standing = 120;
  settings_.moving = 250;  // they would be the majority
  settings_.board = [](int frame) { return Eigen::Vector3d(0, -0.2 + 0.02 * frame, 2); };
  const FollowedPoints made = FollowPoints(settings_);
  left_out_ = made.moves;
  const std::vector<int8_t> votes = Vote(made);
  EXPECT_EQ(ShareOf(made, votes, true, 0), 1);
  EXPECT_GT(ShareOf(made, votes, false, 1), 0.9);
}

TEST_F(VotesByAgreement, AreTheSameForTheSameSeed) {
  const FollowedPoints made = FollowPoints(settings_);
  EXPECT_EQ(Vote(made, 9), Vote(made, 9));
}

TEST_F(VotesByAgreement, AreNotHeldWhereFewHaveSomethingToSay) {
  settings_.standing = 20;
  settings_.moving = 0;
  const FollowedPoints few = FollowPoints(settings_);
  for (int8_t vote : Vote(few)) EXPECT_EQ(vote, 0);
  settings_.standing = 300;
  settings_.frames = 4;
  left_out_.clear();
  const FollowedPoints young = FollowPoints(settings_);
  for (int8_t vote : Vote(young)) EXPECT_EQ(vote, 0);
}

TEST(Consensus, OverrulesASingleSlip) {
  FollowedSettings settings;
  settings.moving = 0;
  settings.standing = 900;
  const FollowedPoints made = FollowPoints(settings);
  std::vector<int8_t> votes(made.tracks.size(), 1);
  for (size_t i = 0; i < votes.size(); i += 25) votes[i] = -1;
  const std::vector<int8_t> agreed = Consensus(Cells(made.camera), made.depth, made.tracks, votes);
  for (int8_t vote : agreed) EXPECT_GE(vote, 0);
  EXPECT_GT(ShareOf(made, agreed, false, 1), 0.5);
}

TEST(Consensus, WhatFewSayHasNoSay) {
  FollowedSettings settings;
  settings.moving = 0;
  settings.standing = 8;
  const FollowedPoints made = FollowPoints(settings);
  const std::vector<int8_t> votes(made.tracks.size(), -1);
  for (int8_t vote : Consensus(Cells(made.camera), {}, made.tracks, votes)) EXPECT_EQ(vote, 0);
}

TEST(Consensus, KeepsWhatAGroupSays) {
  FollowedSettings settings;
  settings.depth = true;
  const FollowedPoints made = FollowPoints(settings);
  std::vector<int8_t> votes;
  for (uint8_t moves : made.moves) votes.push_back(moves ? -1 : 1);
  for (const std::vector<float>& depth : {made.depth, std::vector<float>()}) {
    const std::vector<int8_t> agreed = Consensus(Cells(made.camera), depth, made.tracks, votes);
    EXPECT_GT(ShareOf(made, agreed, true, -1), 0.9);
    EXPECT_EQ(ShareOf(made, agreed, false, -1), 0);
    EXPECT_EQ(ShareOf(made, agreed, true, 1), 0);
  }
}

TEST(Consensus, SurfacesAtOtherDepthsAreNotAsked) {
  // Adjacent tracks; every other one is 1 m nearer, and only those move.
  Camera camera = FollowPoints({}).camera;
  const Cells cells(camera);
  std::vector<float> depth(cells.count(), 3);
  std::vector<FlowTrack> tracks;
  std::vector<int8_t> votes;
  for (int i = 0; i < cells.count(); ++i) {
    const bool near = (i % cells.columns()) % 2 == 0;
    if (near) depth[i] = 2;
    FlowTrack track;
    track.path = {cells.Centre(i)};
    tracks.push_back(track);
    votes.push_back(near ? -1 : 1);
  }
  EXPECT_EQ(Consensus(cells, depth, tracks, votes), votes);
  // Without depth they form one undecidable surface.
  for (int8_t vote : Consensus(cells, {}, tracks, votes)) EXPECT_EQ(vote, 0);
}

}  // namespace
}  // namespace alidade::flow_votes_test
