// Camera paths (SynthSettings::path) and moving objects.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "alidade/base/error.h"
#include "alidade/synth/recording.h"

namespace alidade::ways_test {
namespace {

SynthSettings Small(const std::string& scene, const std::string& path) {
  SynthSettings settings;
  settings.scene = scene;
  settings.path = path;
  settings.width = 320;
  settings.height = 240;
  return settings;
}

// Largest distance from the first position, meters.
double Reach(const SynthRecording& recording, int first, int last) {
  double reach = 0;
  for (int i = first; i <= last; ++i)
    reach = std::max(reach, (recording.Pose(i).t - recording.Pose(first).t).norm());
  return reach;
}

TEST(SynthWays, ATurnOnTheSpotIsAboutTheCamerasCentre) {
  for (const std::string scene : {"room", "street"}) {
    const SynthRecording recording(Small(scene, "turn"));
    EXPECT_LT(Reach(recording, 0, 480), 1e-9) << scene;
    double most = 0;
    for (int i = 0; i < 480; ++i)
      most = std::max(most, RotationAngle(recording.Pose(0), recording.Pose(i)));
    EXPECT_GT(most, 0.95 * std::numbers::pi) << scene;  // a full turn
  }
}

TEST(SynthWays, AnArmCarriesTheCameraRoundTheAxis) {
  SynthSettings settings = Small("room", "turn");
  const SynthRecording about(settings);
  settings.arm = 0.4;
  const SynthRecording round(settings);
  for (int i = 0; i < 480; i += 20) {
    const Eigen::Vector3d arm = round.Pose(i).t - about.Pose(i).t;
    EXPECT_NEAR(arm.norm(), 0.4, 0.02) << i;  // the spline rounds corners
    EXPECT_LT(RotationAngle(about.Pose(i), round.Pose(i)), 1e-12) << i;
  }
}

TEST(SynthWays, TurnsFirstAndThenWalksTheScenesOwnWay) {
  const SynthRecording recording(Small("room", "turn-walk")), own(Small("room", "walk"));
  EXPECT_LT(Reach(recording, 0, 120), 1e-9);
  EXPECT_GT(RotationAngle(recording.Pose(0), recording.Pose(60)), 1);
  EXPECT_GT(Reach(recording, 0, 300), 1);
  // 4 s of rotation, and half a second lost by the acceleration. The rest is shake.
  EXPECT_LT((recording.Pose(285).t - own.Pose(150).t).norm(), 0.1);
  for (int i = 1; i < 300; ++i) {
    EXPECT_LT((recording.Pose(i).t - recording.Pose(i - 1).t).norm(), 0.06) << i;
    EXPECT_LT(RotationAngle(recording.Pose(i), recording.Pose(i - 1)), 0.08) << i;
  }
}

TEST(SynthWays, SpeedIsOfTheWayNotOfTheHand) {
  SynthSettings settings = Small("room", "walk");
  const SynthRecording own(settings);
  settings.speed = 2;
  const SynthRecording fast(settings);
  EXPECT_LT((fast.Pose(90).t - own.Pose(180).t).norm(), 0.1);
  EXPECT_GT((fast.Pose(90).t - own.Pose(90).t).norm(), 0.5);
}

TEST(SynthWays, AStillCameraSeesTheSameButForWhatMoves) {
  SynthSettings settings = Small("desk", "still");
  settings.noise = 0;
  const SynthRecording empty(settings);
  EXPECT_LT(Reach(empty, 0, 100), 1e-12);
  EXPECT_LT(RotationAngle(empty.Pose(0), empty.Pose(100)), 1e-12);
  const RenderedFrame bare = empty.Render(7);
  settings.things = 2;
  const SynthRecording moved(settings);
  double covered = 0, changed = 0;
  cv::Mat before;
  for (const int number : {0, 40, 80}) {
    const RenderedFrame frame = moved.Render(number);
    cv::Mat wide, outside;
    cv::dilate(frame.mask, wide, cv::Mat::ones(3, 3, CV_8U));
    cv::bitwise_and(cv::abs(frame.clean - bare.clean) > 0.01, ~wide, outside);
    EXPECT_EQ(cv::countNonZero(outside), 0) << number;
    covered += cv::countNonZero(frame.mask) / static_cast<double>(frame.mask.total()) / 3;
    if (!before.empty()) changed += cv::countNonZero(before != frame.mask);
    before = frame.mask;
    // The objects are in front of the table.
    cv::Mat behind;
    cv::bitwise_and(frame.depth_exact > bare.depth_exact, frame.mask, behind);
    EXPECT_EQ(cv::countNonZero(behind), 0) << number;
  }
  EXPECT_GT(covered, 0.04);
  EXPECT_LT(covered, 0.5);
  EXPECT_GT(changed, 1000);
}

TEST(SynthWays, ThingsNeedATable) {
  SynthSettings settings = Small("wall", "still");
  settings.things = 1;
  EXPECT_THROW(SynthRecording{settings}, Error);
}

TEST(SynthWays, LowLightIsDarkerAndNoisierAgainstWhatIsSeen) {
  SynthSettings settings = Small("room", "walk");
  settings.frames = 1;
  const auto noise_of = [&](double light, double* bright) {
    settings.light = light;
    const RenderedFrame frame = SynthRecording(settings).Render(0);
    *bright = cv::mean(frame.image)[0] / cv::mean(frame.clean)[0];
    cv::Mat image, mean, deviation;
    frame.image.convertTo(image, CV_32F);
    cv::meanStdDev(image - *bright * frame.clean, mean, deviation);
    return deviation.at<double>(0);
  };
  double day = 0, dusk = 0, night = 0;
  EXPECT_NEAR(noise_of(1, &day), 4, 0.3);
  // Same brightness as by day, with a quarter of the light.
  EXPECT_NEAR(noise_of(0.25, &dusk), 8, 0.6);
  EXPECT_NEAR(noise_of(0.0625, &night), 4, 0.3);
  EXPECT_NEAR(dusk, day, 0.02);
  EXPECT_NEAR(night, day / 4, 0.02);
}

TEST(SynthWays, SettingsSayWhatCannotBe) {
  const auto refused = [](auto change) {
    SynthSettings settings;
    change(settings);
    EXPECT_THROW(settings.Check(), Error);
  };
  refused([](SynthSettings& s) { s.path = "fly"; });
  refused([](SynthSettings& s) { s.speed = 0; });
  refused([](SynthSettings& s) { s.arm = 0.3; });  // only with path "turn"
  refused([](SynthSettings& s) { s.light = 0; });
  refused([](SynthSettings& s) { s.fov = 170; });
  refused([](SynthSettings& s) { s.k1 = -0.5; });  // not invertible at the corners
  refused([](SynthSettings& s) { s.k1 = s.distortion = true; });
  refused([](SynthSettings& s) { s.rolling_shutter = -1; });
  refused([](SynthSettings& s) { s.blur = std::nan(""); });
}

}  // namespace
}  // namespace alidade::ways_test
