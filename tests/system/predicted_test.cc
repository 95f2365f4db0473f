// A camera that is covered for a moment: its pose is predicted, marked as such, and in no
// trajectory.
#include <gtest/gtest.h>

#include "alidade/slam.h"
#include "alidade/synth/recording.h"

namespace alidade::predicted_test {
namespace {

constexpr int kCovered = 20;  // first frame that shows nothing

// RGB-D: lengths are meters, so that predicted poses can be compared with the truth.
struct CoveredLens {
  explicit CoveredLens(int frames, double seconds = 0.5) : recording(Small()) {
    SlamSettings settings;
    settings.ApplyProfile("phone");
    settings.sensor = Sensor::kRgbd;
    settings.tracker.predict_seconds = seconds;
    Slam slam(recording.camera(), settings);
    for (int i = 0; i < kCovered + frames + 5; ++i) {
      RenderedFrame frame = recording.Render(i);
      if (i >= kCovered && i < kCovered + frames) {
        frame.image.setTo(cv::Scalar::all(40));
        frame.depth.setTo(0);
      }
      results.push_back(slam.Track({frame.time, frame.image, {}, frame.depth}));
    }
    slam.Finish();
    trajectory = slam.Trajectory();
    counts = slam.Counts();
  }

  static SynthSettings Small() {
    SynthSettings settings;
    settings.width = 400;
    settings.height = 300;
    return settings;
  }
  Se3 TrueFromFirst(int i) const { return recording.Pose(0).Inverse() * recording.Pose(i); }

  SynthRecording recording;
  std::vector<TrackResult> results;
  std::vector<FramePose> trajectory;
  SlamCounts counts;
};

TEST(Predicted, IsNearTheTruthForAMomentAndInNoTrajectory) {
  const CoveredLens run(10);
  for (int i = 0; i < kCovered; ++i) EXPECT_FALSE(run.results[static_cast<size_t>(i)].predicted);
  for (int i = kCovered; i < kCovered + 10; ++i) {
    const TrackResult& result = run.results[static_cast<size_t>(i)];
    EXPECT_EQ(result.state, TrackState::kLost);
    ASSERT_TRUE(result.predicted) << i;
    EXPECT_FALSE(run.trajectory[static_cast<size_t>(i)].tracked);
    // Closer than the last tracked pose.
    const Se3 truth = run.TrueFromFirst(i);
    const double stood = (run.TrueFromFirst(kCovered - 1).t - truth.t).norm();
    EXPECT_LT((result.predicted->t - truth.t).norm(), 0.7 * stood) << i;
  }
  EXPECT_EQ(run.counts.predicted, 10);
  for (size_t i = kCovered + 10; i < run.results.size(); ++i) {
    EXPECT_EQ(run.results[i].state, TrackState::kTracking) << run.results[i].reason();
    EXPECT_LT((run.results[i].T_world_camera.t - run.TrueFromFirst(static_cast<int>(i)).t).norm(),
              0.01);
  }
}

TEST(Predicted, EndsWhenTheMotionIsTooLongAgo) {
  const CoveredLens run(25);  // frames, at 30 per second
  EXPECT_EQ(run.counts.predicted, 15);
  EXPECT_TRUE(run.results[kCovered + 14].predicted);
  EXPECT_FALSE(run.results[kCovered + 15].predicted);
  EXPECT_EQ(run.results.back().state, TrackState::kTracking);
}

TEST(Predicted, CanBeSwitchedOff) {
  const CoveredLens run(5, 0);
  EXPECT_EQ(run.counts.predicted, 0);
  for (const TrackResult& result : run.results) EXPECT_FALSE(result.predicted);
}

}  // namespace
}  // namespace alidade::predicted_test
