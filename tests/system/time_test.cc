// Irregular time stamps: gaps, clocks that are set back, several recordings, dropped frames.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/slam.h"
#include "support/rendered_frames.h"

namespace alidade::time_test {
namespace {

class Time : public testing::Test {
 protected:
  Time() : slam_(SmallRoom().camera(), Phone()) {
    SetWarningListener([this](const std::string& warning) { warnings_.push_back(warning); });
  }
  ~Time() override { SetWarningListener(nullptr); }

  static SlamSettings Phone() {
    SlamSettings settings;
    settings.ApplyProfile("phone");
    settings.sensor = Sensor::kRgbd;
    return settings;
  }

  // False if the frame was refused.
  bool Show(int number, double time) {
    const RenderedFrame& frame = SmallRoom().Frame(number);
    try {
      result_ = slam_.Track({time, frame.image, {}, frame.depth});
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInput);
      return false;
    }
    shown_.push_back(number);
    return true;
  }
  // Frames `first` to `last`, ten per second from `time` on. Returns how many were accepted.
  int ShowAll(int first, int last, double time) {
    int taken = 0;
    for (int i = first; i <= last; ++i) taken += Show(i, time + 0.1 * (i - first));
    return taken;
  }

  // Expects that all frames but `lost` are tracked in one map, close to their true positions.
  void ExpectTracked(int lost) const {
    int untracked = 0;
    for (const FramePose& pose : slam_.Trajectory()) {
      untracked += !pose.tracked;
      if (!pose.tracked) continue;
      const Se3 truth =
          SmallRoom().Pose(shown_[0]).Inverse() * SmallRoom().Pose(shown_[pose.index]);
      EXPECT_LT((pose.T_world_camera.t - truth.t).norm(), 0.05) << pose.index;
    }
    EXPECT_EQ(untracked, lost);
    EXPECT_EQ(slam_.Snapshot().Maps().size(), 1u);
  }

  Slam slam_;
  TrackResult result_;
  std::vector<int> shown_;  // accepted frames
  std::vector<std::string> warnings_;
};

TEST_F(Time, OneStampAnHourAheadCostsTwoFrames) {
  EXPECT_EQ(ShowAll(0, 9, 1000), 10);
  EXPECT_TRUE(Show(10, 1000 + 3601));
  EXPECT_STREQ(result_.cut, "after a gap in time");
  EXPECT_EQ(ShowAll(11, 30, 1001.1), 18);
  EXPECT_EQ(result_.state, TrackState::kTracking);
  EXPECT_EQ(slam_.Counts().cuts, 2);
  EXPECT_EQ(warnings_.size(), 1u);
  ExpectTracked(0);
}

TEST_F(Time, AClockThatIsSetBackIsFollowed) {
  EXPECT_EQ(ShowAll(0, 9, 1000), 10);
  EXPECT_FALSE(Show(10, 5.0));
  EXPECT_FALSE(Show(11, 5.1));
  EXPECT_TRUE(Show(12, 5.2));
  EXPECT_STREQ(result_.cut, "the clock was set back");
  EXPECT_EQ(ShowAll(13, 20, 5.3), 8);
  EXPECT_STREQ(result_.cut, "");
  ExpectTracked(0);
  const std::vector<FramePose> trajectory = slam_.Trajectory();
  for (size_t i = 0; i < trajectory.size(); ++i) EXPECT_EQ(trajectory[i].recording, i < 10 ? 0 : 1);
  ASSERT_EQ(warnings_.size(), 1u);
  EXPECT_NE(warnings_[0].find("back by 995.7 s"), std::string::npos) << warnings_[0];
}

TEST_F(Time, ALostCameraWhoseClockIsSetBackBeginsANewMapInTime) {
  SlamSettings settings = Phone();
  settings.new_map_frames = 8;
  Slam slam(SmallRoom().camera(), settings);
  const auto show = [&](int number, double time) {
    const RenderedFrame& frame = SmallRoom().Frame(number);
    return slam.Track({time, frame.image, {}, frame.depth});
  };
  for (int i = 0; i <= 48; i += 3) show(i, 1000 + 0.1 * i);
  const cv::Mat covered(SmallRoom().camera().height, SmallRoom().camera().width, CV_8U,
                        cv::Scalar(10));
  EXPECT_EQ(slam.Track({1005, covered, {}, SmallRoom().Frame(330).depth}).state, TrackState::kLost);
  int tracked = 0;
  for (int i = 1; i <= 20; ++i) {  // a part of the room that was not seen before
    try {
      tracked += show(330 + 6 * i, 0.1 * i).state == TrackState::kTracking;
    } catch (const Error&) {
      EXPECT_LT(i, 3);
    }
  }
  EXPECT_GT(tracked, 0);
}

TEST_F(Time, AfterAGapTheCameraIsFoundWhereItIs) {
  EXPECT_EQ(ShowAll(0, 30, 0), 31);
  EXPECT_TRUE(Show(12, 600));  // the camera was carried back meanwhile
  EXPECT_STREQ(result_.cut, "after a gap in time");
  EXPECT_EQ(result_.state, TrackState::kTracking);
  EXPECT_EQ(slam_.Counts().relocalizations, 1);
  EXPECT_EQ(ShowAll(13, 20, 600.1), 8);
  ExpectTracked(0);
}

TEST_F(Time, AMapOfOneCameraOnTrialDoesNotSurviveAGap) {
  SlamSettings settings = Phone();
  settings.sensor = Sensor::kMono;
  settings.start.trial_frames = 1000;
  Slam slam(SmallRoom().camera(), settings);
  int i = 0;
  TrackResult result;
  for (; i < 60 && result.state != TrackState::kTracking; ++i)
    result = slam.Track({0.1 * i, SmallRoom().Frame(i).image, {}, {}});
  ASSERT_EQ(result.state, TrackState::kTracking);
  result = slam.Track({600, SmallRoom().Frame(i).image, {}, {}});
  EXPECT_EQ(result.state, TrackState::kInitializing);
  EXPECT_EQ(slam.Snapshot().keyframe_count(), 0);
}

TEST_F(Time, AResetBeginsANewRecordingInTheSameMaps) {
  EXPECT_EQ(ShowAll(0, 30, 1000), 31);
  slam_.Reset();
  slam_.Reset();                      // the second call does nothing
  EXPECT_EQ(ShowAll(10, 20, 0), 11);  // earlier times
  EXPECT_EQ(slam_.Counts().cuts, 1);
  slam_.Reset();
  EXPECT_TRUE(Show(15, 0.5));
  EXPECT_STREQ(result_.cut, "a new recording");
  ExpectTracked(0);
  EXPECT_EQ(slam_.Trajectory().back().recording, 2);
  EXPECT_TRUE(warnings_.empty());
}

TEST_F(Time, AResetBeforeTheFirstFrameIsNothing) {
  slam_.Reset();
  EXPECT_EQ(ShowAll(0, 5, 3), 6);
  EXPECT_EQ(slam_.Counts().cuts, 0);
  EXPECT_EQ(slam_.Trajectory().back().recording, 0);
}

TEST_F(Time, AResetSomewhereElseBeginsAMapOfItsOwnWhenNoPlaceIsKnown) {
  EXPECT_EQ(ShowAll(0, 30, 1000), 31);
  slam_.Reset();
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(Show(330 + 6 * i, 0.1 * i));
  EXPECT_EQ(result_.state, TrackState::kTracking);
  EXPECT_EQ(slam_.Snapshot().Maps().size(), 2u);
}

TEST_F(Time, DroppedFramesAreTrackedOn) {
  // Steps between the frames that a busy machine accepts of 30 per second.
  int number = 0;
  for (const int step : {1, 1, 3, 1, 2, 6, 1, 1, 4, 1, 7, 2, 1, 8, 1, 1, 3, 9, 1, 5, 1, 0}) {
    EXPECT_TRUE(Show(number, number / 30.0));
    EXPECT_EQ(result_.state, TrackState::kTracking) << number;
    const Se3 truth = SmallRoom().Pose(0).Inverse() * SmallRoom().Pose(number);
    // 0.08 m if the prediction assumes the same step for 0.2 s as for 0.07 s.
    EXPECT_LT((result_.T_world_camera.t - truth.t).norm(), 0.03) << number;
    number += step;
  }
  EXPECT_EQ(slam_.Counts().cuts, 0);
  ExpectTracked(0);
}

}  // namespace
}  // namespace alidade::time_test
