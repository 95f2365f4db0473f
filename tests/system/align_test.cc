// Frames between keyframes are aligned (expert.tracker.align): fewer extractions, poses as good.
#include <gtest/gtest.h>

#include <functional>
#include <opencv2/imgproc.hpp>

#include "alidade/base/parallel.h"
#include "alidade/evaluation/ate.h"
#include "alidade/slam.h"
#include "support/rendered_frames.h"

namespace alidade::align_test {
namespace {

constexpr int kFrames = 100;

struct Outcome {
  int tracked = 0;
  size_t extracted = 0;  // frames
  double rmse = 0;       // meters; after Sim(3) for one camera
  std::string trajectory;
};

SlamSettings Settings(Sensor sensor, bool align) {
  SlamSettings settings;
  settings.sensor = sensor;
  settings.tracker.align = align;
  settings.tracker.extractor.features = 600;  // for a small image
  settings.tracker.match_scale = settings.mapper.match_scale = settings.start.match_scale = 0.8;
  settings.fixed_parts = false;       // frames that are kept for it are extracted
  settings.early.settle_frames = 10;  // so are these
  return settings;
}

using Change = std::function<void(int number, cv::Mat& image)>;

Outcome Play(RenderedFrames& room, const SlamSettings& settings, const Change& change = {}) {
  Camera camera = room.camera();
  if (settings.sensor != Sensor::kStereo) camera.baseline = 0;
  Slam slam(camera, settings);
  Outcome outcome;
  for (int i = 0; i < kFrames; ++i) {
    const RenderedFrame& frame = room.Frame(i);
    cv::Mat image = frame.image.clone();
    if (change) change(i, image);
    FrameInput input{frame.time, image, {}, {}};
    if (settings.sensor == Sensor::kStereo) input.right = frame.right;
    if (settings.sensor == Sensor::kRgbd) input.depth = frame.depth;
    slam.Track(input);
  }
  slam.Finish();
  Trajectory truth, estimate;
  for (const FramePose& pose : slam.Trajectory()) {
    truth.push_back({pose.time, room.Pose(pose.index), {}});
    if (!pose.tracked) continue;
    ++outcome.tracked;
    estimate.push_back({pose.time, pose.T_world_camera, {}});
  }
  outcome.extracted = slam.Times().extract.size();
  outcome.trajectory = FormatTumTrajectory(estimate);
  const Alignment alignment = settings.sensor == Sensor::kMono ? Alignment::kSim3 : Alignment::kSe3;
  outcome.rmse = EvaluateAte(truth, estimate, {.align = alignment}).error.rmse;
  return outcome;
}

RenderedFrames& Room(Sensor sensor) {
  SynthSettings settings;
  settings.width = 400;
  settings.height = 300;
  settings.seed = 21;
  settings.stereo = sensor == Sensor::kStereo;
  return FramesOf(settings);
}

class AlignTest : public testing::TestWithParam<Sensor> {};

TEST_P(AlignTest, ExtractsFewFramesAndIsAsAccurate) {
  RenderedFrames& room = Room(GetParam());
  const Outcome all = Play(room, Settings(GetParam(), false));
  const Outcome some = Play(room, Settings(GetParam(), true));
  EXPECT_EQ(all.extracted, size_t{kFrames});
  EXPECT_LT(some.extracted, size_t{70});
  EXPECT_GE(some.tracked, all.tracked - 1);
  EXPECT_LT(some.rmse, std::max(1.3 * all.rmse, 0.01));
}

TEST_P(AlignTest, GivesTheSameBytesWithOneAndTwoThreads) {
  RenderedFrames& room = Room(GetParam());
  SetThreadCount(1);
  const Outcome one = Play(room, Settings(GetParam(), true));
  SetThreadCount(2);
  const Outcome two = Play(room, Settings(GetParam(), true));
  SetThreadCount(0);
  EXPECT_EQ(one.trajectory, two.trajectory);
  EXPECT_EQ(one.extracted, two.extracted);
}

// The check of a chair's back repeats after 11 pixels, which is 1.4 on the coarsest image. The
// chair is near and the rest is far, so that a pose 10 cm away would fit, with the check moved by
// one.
TEST(AlignRepetition, AChecksNeighborIsNotTakenForIt) {
  RenderedFrames& room = SmallRoom(320, 240);
  SlamSettings settings;
  settings.sensor = Sensor::kRgbd;
  Slam slam(room.camera(), settings);
  for (int i = 0; i < 120; ++i) {
    const RenderedFrame& frame = room.Frame(i);
    slam.Track({frame.time, frame.image, {}, frame.depth});
  }
  slam.Finish();
  const std::vector<FramePose> poses = slam.Trajectory();
  double worst = 0;
  for (size_t i = 1; i < poses.size(); ++i) {
    const Se3 step = poses[i - 1].T_world_camera.Inverse() * poses[i].T_world_camera;
    const Se3 truth = room.Pose(poses[i - 1].index).Inverse() * room.Pose(poses[i].index);
    worst = std::max(worst, (step.t - truth.t).norm());
  }
  EXPECT_LT(worst, 0.03);  // meters
}

INSTANTIATE_TEST_SUITE_P(Sensors, AlignTest,
                         testing::Values(Sensor::kMono, Sensor::kRgbd, Sensor::kStereo));

TEST(Align, AllowsForAnExposureThatChangesFromOneFrameToTheNext) {
  RenderedFrames& room = Room(Sensor::kRgbd);
  const Outcome steady = Play(room, Settings(Sensor::kRgbd, true));
  const Outcome stepping =
      Play(room, Settings(Sensor::kRgbd, true), [](int number, cv::Mat& image) {
        image.convertTo(image, -1, number % 8 < 4 ? 1 : 0.6, number % 8 < 4 ? 0 : 20);
      });
  EXPECT_EQ(stepping.tracked, kFrames);
  EXPECT_LT(stepping.extracted, 2 * steady.extracted);
  EXPECT_LT(stepping.rmse, std::max(1.5 * steady.rmse, 0.01));
}

TEST(Align, ExtractsWhereImagesAreBlurredAndGoesOnAfterwards) {
  RenderedFrames& room = Room(Sensor::kRgbd);
  const Outcome outcome = Play(room, Settings(Sensor::kRgbd, true), [](int number, cv::Mat& image) {
    if (number >= 50 && number < 55) cv::blur(image, image, {15, 1});
    if (number == 70) image.setTo(0);
  });
  EXPECT_GE(outcome.tracked, kFrames - 3);
  EXPECT_LT(outcome.extracted, size_t{75});
  EXPECT_LT(outcome.rmse, 0.03);
}

TEST(Align, UsesNothingWhereTheUserLeavesOut) {
  RenderedFrames& room = Room(Sensor::kRgbd);
  Camera camera = room.camera();
  camera.baseline = 0;
  Slam slam(camera, Settings(Sensor::kRgbd, true));
  cv::Mat mask = cv::Mat::zeros(30, 40, CV_8U);
  mask.colRange(0, 15).setTo(255);
  slam.LeaveOut(mask);
  size_t features = 0;
  for (int i = 0; i < kFrames; ++i) {
    const RenderedFrame& frame = room.Frame(i);
    slam.Track({frame.time, frame.image, {}, frame.depth});
    for (const FeatureUse& feature : slam.Features()) {
      ++features;
      EXPECT_GE(feature.x, 149.0f);
    }
  }
  EXPECT_LT(slam.Times().extract.size(), size_t{80});  // the others were aligned
  EXPECT_GT(features, size_t{5000});
}

}  // namespace
}  // namespace alidade::align_test
