// What a rendered source can be asked for, and what it tells of its camera.
#include "alidade/run/sources/synth_source.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

#include "alidade/base/error.h"

namespace alidade::synth_source_test {
namespace {

double FovOf(const Camera& camera) {
  return 2 * std::atan(camera.width / 2.0 / camera.fx) * 180 / std::numbers::pi;
}

TEST(SynthSource, OptionsAreTheFlagsOfTheCommand) {
  const SynthSettings settings = ParseSynthSource(
      "synth:desk?path=still&things=2&speed=1.5&fov=50&light=0.2&blur=35&rolling_shutter=30&k1=-0.1"
      "&calibrated=0&fps=3.5");
  EXPECT_EQ(settings.path, "still");
  EXPECT_EQ(settings.things, 2);
  EXPECT_EQ(settings.speed, 1.5);
  EXPECT_EQ(settings.fov, 50);
  EXPECT_EQ(settings.light, 0.2);
  EXPECT_EQ(settings.blur, 35);
  EXPECT_EQ(settings.rolling_shutter, 30);
  EXPECT_EQ(settings.k1, -0.1);
  EXPECT_EQ(settings.fps, 3.5);
  EXPECT_FALSE(settings.calibrated);
}

TEST(SynthSource, SwitchesStandForWhatIsUsual) {
  for (const char* on : {"synth:room?blur&rolling", "synth:room?blur=1&rolling=true"}) {
    EXPECT_EQ(ParseSynthSource(on).blur, 20) << on;
    EXPECT_EQ(ParseSynthSource(on).rolling_shutter, 16) << on;
  }
  const SynthSettings off = ParseSynthSource("synth:room?blur=0&rolling=false");
  EXPECT_EQ(off.blur, 0);
  EXPECT_EQ(off.rolling_shutter, 0);
}

TEST(SynthSource, RefusesWhatItDoesNotKnow) {
  const auto problem = [](const std::string& source) -> std::string {
    try {
      ParseSynthSource(source);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(problem("synth:room?rolling_shuter=3").find("rolling_shutter"), std::string::npos);
  EXPECT_NE(problem("synth:room?path=trun").find("turn"), std::string::npos);
  EXPECT_NE(problem("synth:room?light=dark").find("light"), std::string::npos);
  EXPECT_NE(problem("synth:rom").find("street"), std::string::npos);
}

TEST(SynthSource, TellsItsCameraUnlessNothingIsKnownOfIt) {
  const std::string upright = "synth:wall?frames=1&width=90&height=160&fov=35";
  EXPECT_NEAR(FovOf(OpenSynthSource(upright)->Info().camera), 35, 1e-6);
  const auto unknown = OpenSynthSource(upright + "&calibrated=0");
  EXPECT_TRUE(unknown->Info().camera_guessed);
  EXPECT_NEAR(FovOf(unknown->Info().camera), 40.1, 0.1);  // 66 degrees along the longer side
  SourceOptions told;
  told.fov_degrees = 44;
  const auto said = OpenSynthSource(upright + "&calibrated=0", told);
  EXPECT_FALSE(said->Info().camera_guessed);
  EXPECT_NEAR(FovOf(said->Info().camera), 44, 1e-6);
}

// A fisheye that is known is made a pinhole, as a recorded one is: what it sees there is what a
// pinhole sees.
TEST(SynthSource, AKnownFisheyeIsRectified) {
  const std::string room = "synth:room?frames=1&width=320&height=240&noise=0";
  const auto fisheye = OpenSynthSource(room + "&fisheye&fov=80");
  const Camera& camera = fisheye->Info().camera;
  EXPECT_FALSE(camera.HasDistortion());
  char fov[40];
  std::snprintf(fov, sizeof(fov), "&fov=%.9f", FovOf(camera));
  const auto pinhole = OpenSynthSource(room + fov);
  ASSERT_NEAR(pinhole->Info().camera.cx, camera.cx, 0.51);
  const cv::Mat a = fisheye->Next()->image, b = pinhole->Next()->image;
  const cv::Rect inside(40, 40, 240, 160);
  EXPECT_LT(cv::norm(a(inside), b(inside), cv::NORM_L1) / inside.area(), 4);
  const cv::Mat elsewhere = b(inside + cv::Point(4, 0));
  EXPECT_GT(cv::norm(a(inside), elsewhere, cv::NORM_L1) / inside.area(), 5);
}

// Readings follow each other from frame to frame; after a jump they begin shortly before the frame.
TEST(SynthSource, ReadingsComeWithTheFrames) {
  const std::string table = "synth:table?frames=40&width=64&height=48";
  EXPECT_FALSE(OpenSynthSource(table)->Info().imu.has_value());
  for (const char* imu : {"&imu=adis&imu-offset=15", "&imu=phone&imu_rate=200&imu-offset=-12"}) {
    const auto source = OpenSynthSource(table + imu);
    const ImuModel model = source->Info().imu.value();
    std::vector<ImuSample> all, fifth;
    double last = 0;
    for (int i = 0; i < 6; ++i) {
      const SourceFrame frame = source->Next().value();
      ASSERT_FALSE(frame.imu.empty());
      EXPECT_LE(frame.imu.back().time, frame.time + model.time_offset);
      EXPECT_GT(frame.imu.back().time, frame.time + model.time_offset - 0.01);
      all.insert(all.end(), frame.imu.begin(), frame.imu.end());
      fifth = frame.imu;
      last = frame.time;
    }
    EXPECT_NEAR(all.front().time, model.time_offset - 0.1, 0.008);
    EXPECT_NEAR(static_cast<double>(all.size()), 200 * (last + 0.1), 2);
    for (size_t i = 1; i < all.size(); ++i) EXPECT_NEAR(all[i].time - all[i - 1].time, 5e-3, 4e-3);
    ASSERT_TRUE(source->Seek(5));
    const auto again = source->Next().value().imu;
    ASSERT_GT(again.size(), fifth.size());
    for (size_t i = 1; i <= fifth.size(); ++i) {
      EXPECT_EQ(again[again.size() - i].time, fifth[fifth.size() - i].time);
      EXPECT_EQ(again[again.size() - i].angular_rate, fifth[fifth.size() - i].angular_rate);
    }
  }
}

// The sensor's rotation is told of the camera that is handed out: rectified, of a fisheye.
TEST(SynthSource, TellsTheSensorInTheRectifiedCamera) {
  const auto source = OpenSynthSource("synth:table?frames=1&imu=adis&fisheye&fov=90");
  const ImuModel model = source->Info().imu.value();
  EXPECT_TRUE(model.rotation_known);
  EXPECT_LT((model.T_camera_imu.R.col(0) - Eigen::Vector3d(0, -1, 0)).norm(), 0.05);
  EXPECT_FALSE(OpenSynthSource("synth:table?frames=1&imu=phone")->Info().imu->rotation_known);
}

}  // namespace
}  // namespace alidade::synth_source_test
