// Recordings are reproducible, sufficiently difficult, and their masks mark the people.
#include "alidade/synth/recording.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "alidade/base/error.h"
#include "alidade/base/parallel.h"
#include "alidade/synth/sensor.h"
#include "alidade/synth/statistics.h"

namespace alidade::recording_test {
namespace {

bool Same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0;
}

void ExpectSame(const RenderedFrame& a, const RenderedFrame& b) {
  EXPECT_TRUE(Same(a.image, b.image));
  EXPECT_TRUE(Same(a.depth, b.depth));
  EXPECT_TRUE(Same(a.depth_exact, b.depth_exact));
  EXPECT_TRUE(Same(a.mask, b.mask));
}

SynthSettings Small(const std::string& scene) {
  SynthSettings settings;
  settings.scene = scene;
  settings.width = 320;
  settings.height = 240;
  return settings;
}

TEST(SynthRecording, IsTheSameWithOneThreadAndTwoAndInAnyOrder) {
  SynthSettings settings = Small("room");
  settings.actors = 2;
  settings.rolling_shutter = 16;
  settings.exposure = true;
  SetThreadCount(1);
  const SynthRecording one(settings);
  const RenderedFrame first = one.Render(30);
  SetThreadCount(2);
  const SynthRecording two(settings);
  two.Render(10);
  const RenderedFrame again = two.Render(30);
  SetThreadCount(0);
  ExpectSame(first, again);
  EXPECT_FALSE(Same(first.image, one.Render(31).image));
}

TEST(SynthRecording, SeedsGiveOtherPlacesAndShake) {
  SynthSettings settings = Small("desk");
  const SynthRecording one(settings);
  settings.seed = 2;
  const SynthRecording two(settings);
  EXPECT_GT((one.Pose(20).t - two.Pose(20).t).norm(), 1e-4);
  EXPECT_FALSE(Same(one.Render(20).image, two.Render(20).image));
}

TEST(SynthRecording, PeopleAreWhereTheMaskSaysAndTheyMove) {
  SynthSettings settings = Small("room");
  const SynthRecording empty(settings);
  settings.actors = 3;
  const SynthRecording peopled(settings);
  double covered = 0;
  int changed_outside = 0, closer = 0, masked = 0;
  for (const int number : {0, 60, 120, 180}) {
    const RenderedFrame without = empty.Render(number), with = peopled.Render(number);
    EXPECT_EQ(cv::countNonZero(without.mask), 0);
    covered += cv::countNonZero(with.mask) / static_cast<double>(with.mask.total()) / 4;
    // The border of the mask is blended with the background.
    cv::Mat wide;
    cv::dilate(with.mask, wide, cv::Mat::ones(3, 3, CV_8U));
    for (int y = 0; y < with.mask.rows; ++y) {
      for (int x = 0; x < with.mask.cols; ++x) {
        if (wide.at<uint8_t>(y, x) == 0)
          changed_outside += with.clean.at<float>(y, x) != without.clean.at<float>(y, x);
        if (with.mask.at<uint8_t>(y, x) == 0) continue;
        ++masked;
        closer += with.depth_exact.at<float>(y, x) < without.depth_exact.at<float>(y, x);
      }
    }
  }
  EXPECT_EQ(changed_outside, 0);
  EXPECT_GT(covered, 0.01);
  EXPECT_LT(covered, 0.5);
  EXPECT_GT(closer, 0.999 * masked);
  EXPECT_FALSE(Same(peopled.Render(0).mask, peopled.Render(60).mask));
}

TEST(SynthRecording, NoiseHasTheDeviationAskedFor) {
  SynthSettings settings = Small("wall");
  const SynthRecording recording(settings);
  const RenderedFrame frame = recording.Render(5);
  cv::Mat image, mean, deviation;
  frame.image.convertTo(image, CV_32F);
  cv::meanStdDev(image - frame.clean, mean, deviation);
  EXPECT_NEAR(deviation.at<double>(0), std::hypot(settings.noise, 0.29), 0.1);  // plus rounding
  EXPECT_NEAR(mean.at<double>(0), 0, 0.1);
}

TEST(SynthRecording, BlurSmearsAndExposureDrifts) {
  SynthSettings settings = Small("room");
  settings.noise = 0;
  const auto sharpness = [](const cv::Mat& grey) {
    cv::Mat laplacian;
    cv::Laplacian(grey, laplacian, CV_32F);
    return cv::norm(laplacian, cv::NORM_L1);
  };
  const SynthRecording still(settings);
  int fastest = 0;  // frame with the fastest rotation
  const auto turn = [&still](int i) { return RotationAngle(still.Pose(i), still.Pose(i + 1)); };
  for (int i = 0; i < 300; ++i) {
    if (turn(i) > turn(fastest)) fastest = i;
  }
  settings.blur = 20;
  EXPECT_LT(sharpness(SynthRecording(settings).Render(fastest).clean),
            0.85 * sharpness(still.Render(fastest).clean));
  settings.blur = 0;
  settings.exposure = true;
  const SynthRecording drifting(settings);
  double darkest = 1e9, brightest = 0;
  for (int i = 0; i < 600; i += 60) {
    const RenderedFrame frame = drifting.Render(i);
    const double ratio = cv::mean(frame.image)[0] / cv::mean(frame.clean)[0];
    darkest = std::min(darkest, ratio);
    brightest = std::max(brightest, ratio);
  }
  EXPECT_GT(brightest / darkest, 1.2);
}

TEST(DepthSensor, ErrsBySteepeningStepsAndIsBlindAtEdgesAndFarAway) {
  for (const double z : {1.0, 2.0, 4.0}) {
    const cv::Mat1f flat(100, 100, static_cast<float>(z));
    const cv::Mat depth = SenseDepth(flat, 525, 5000, {});
    double sum = 0;
    int readings = 0;
    for (int y = 0; y < 100; ++y) {
      for (int x = 0; x < 100; ++x) {
        const double value = depth.at<uint16_t>(y, x) / 5000.0;
        if (value == 0) continue;
        sum += (value - z) * (value - z);
        ++readings;
      }
    }
    EXPECT_GT(readings, 9800);
    // Disparity error from noise and quantization (Khoshelham & Elberink 2012, eq. 7): sigma_z = z²
    // / (f b) sigma_d.
    const DepthSensorSettings sensor;
    const double sigma_d =
        std::hypot(sensor.disparity_sigma, sensor.disparity_step / std::sqrt(12.0));
    EXPECT_NEAR(std::sqrt(sum / readings), z * z / (525 * sensor.baseline) * sigma_d,
                0.2 * z * z / (525 * sensor.baseline) * sigma_d)
        << z;
  }
  cv::Mat1f step(60, 120, 3.0f);
  step.colRange(60, 120) = 1.0f;
  const cv::Mat depth = SenseDepth(step, 525, 5000, {});
  // Ragged: almost no readings directly at the edge.
  EXPECT_LT(cv::countNonZero(depth.col(59)) + cv::countNonZero(depth.col(60)), 30);
  // The projector is to the right of the camera, so its shadow is left of the near object: f b (1 -
  // 1/3) = 26 pixels wide.
  EXPECT_EQ(cv::countNonZero(depth.colRange(36, 57)), 0);
  EXPECT_GT(cv::countNonZero(depth.colRange(0, 30)), 0.95 * 60 * 30);
  EXPECT_GT(cv::countNonZero(depth.colRange(64, 120)), 0.95 * 60 * 56);
  const cv::Mat1f far(20, 20, 9.0f);
  EXPECT_EQ(cv::countNonZero(SenseDepth(far, 525, 5000, {})), 0);
}

TEST(SynthRecording, HeldFramesShowWhereTheCameraIsByThen) {
  SynthSettings settings;
  settings.frames = 400;
  const SynthRecording even(settings);
  settings.held = 0.05;
  const SynthRecording busy(settings);
  int late = 0;
  for (int i = 1; i < settings.frames; ++i) {
    const double gap = busy.Time(i) - busy.Time(i - 1) - 1.0 / settings.fps;
    if (gap < 1e-9) continue;
    ++late;
    EXPECT_GE(gap, 0.2);
    EXPECT_LE(gap, 1.0);
  }
  EXPECT_GE(late, 8);
  EXPECT_LE(late, 35);
  // Compare the poses 3 s after the start by both clocks.
  int i = 0;
  while (busy.Time(i) < 3) ++i;
  const int same = static_cast<int>(std::lround(busy.Time(i) * settings.fps));
  EXPECT_LT(i, same);
  EXPECT_LT((busy.Pose(i).t - even.Pose(same).t).norm(), 0.05);
}

TEST(SynthSettings, SayWhatCannotBe) {
  SynthSettings settings;
  settings.scene = "rom";
  EXPECT_THROW(settings.Check(), Error);
  settings = {};
  settings.frames = 0;
  EXPECT_THROW(settings.Check(), Error);
  settings = {};
  settings.noise = std::nan("");
  EXPECT_THROW(SynthRecording{settings}, Error);
}

}  // namespace
}  // namespace alidade::recording_test
