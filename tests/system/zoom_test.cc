// A focal length that changes during a recording: by one or two per cent with autofocus, by more
// with a zoom.
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "alidade/evaluation/ate.h"
#include "alidade/slam.h"
#include "support/rendered_frames.h"

namespace alidade::zoom_test {
namespace {

struct Ran {
  double coverage = 0, ate = 0;  // share of frames with a pose; meters
};

// Scales images about the principal point: by a factor between 2 - `most` and `most`, with a period
// of two seconds; with `to_stay` once to `most`, within half a second in the middle of the
// recording.
Ran RunRoom(double most, bool to_stay = false) {
  constexpr int kFrames = 200;
  SynthSettings synth;
  synth.width = 400;
  synth.height = 300;
  RenderedFrames& recording = FramesOf(synth);
  SlamSettings settings;
  settings.ApplyProfile("phone");
  Slam slam(recording.camera(), settings);
  Trajectory truth, estimate;
  for (int i = 0; i < kFrames; ++i) {
    const RenderedFrame& frame = recording.Frame(i);
    const double share =
        to_stay ? std::clamp((i - kFrames / 2) / 15.0, 0.0, 1.0) : std::sin(M_PI * frame.time);
    const double zoom = 1 + (most - 1) * share;
    const Camera& camera = recording.camera();
    const cv::Mat grow = (cv::Mat_<double>(2, 3) << zoom, 0, (1 - zoom) * camera.cx, 0, zoom,
                          (1 - zoom) * camera.cy);
    cv::Mat image;
    cv::warpAffine(frame.image, image, grow, frame.image.size(), cv::INTER_LINEAR,
                   cv::BORDER_REFLECT);
    slam.Track({frame.time, image, {}, {}});
    truth.push_back({frame.time, recording.Pose(i), {}});
  }
  slam.Finish();
  for (const FramePose& pose : slam.Trajectory()) {
    if (pose.tracked) estimate.push_back({pose.time, pose.T_world_camera, {}});
  }
  Ran ran;
  ran.coverage = estimate.size() / static_cast<double>(kFrames);
  if (estimate.size() > 10)
    ran.ate = EvaluateAte(truth, estimate, {.align = Alignment::kSim3}).error.rmse;
  return ran;
}

TEST(Zoom, BreathingOfAPerCentOrTwoLosesNothing) {
  for (double most : {1.01, 1.02}) {
    const Ran ran = RunRoom(most);
    EXPECT_EQ(ran.coverage, 1);
    EXPECT_LT(ran.ate, 0.1);
  }
}

}  // namespace
}  // namespace alidade::zoom_test
