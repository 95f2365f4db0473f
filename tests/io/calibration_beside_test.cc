// Calibrations of other tools in the folder of a recording.
#include "alidade/io/files/calibration_beside.h"

#include <gtest/gtest.h>

#include "alidade/base/log.h"
#include "alidade/io/files/open_source.h"
#include "support/expect_error.h"
#include "support/tiny_recording.h"

namespace alidade::calibration_beside_test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr char kRos[] =
    "image_width: 64\nimage_height: 48\ncamera_name: c\ncamera_matrix: {rows: 3, cols: 3, data: "
    "[60, 0, 31, 0, 61, 24, 0, 0, 1]}\ndistortion_model: plumb_bob\ndistortion_coefficients: "
    "{rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\n";
constexpr char kOwn[] =
    "model: pinhole\nwidth: 64\nheight: 48\nfx: 50\nfy: 50\ncx: 31\ncy: 24\ndepth_factor: 1000\n";

// COLMAP's pixel origin is the image's corner.
std::string Colmap(double fx) {
  return "1 PINHOLE 64 48 " + std::to_string(fx) + " 61 31.5 24.5\n";
}

std::string Kalibr(double fx) {
  return "cam0:\n  camera_model: pinhole\n  distortion_coeffs: [0, 0, 0, 0]\n  distortion_model: "
         "radtan\n  intrinsics: [" +
         std::to_string(fx) + ", 61, 31, 24]\n  resolution: [64, 48]\n";
}

class CalibrationBeside : public testing::Test {
 protected:
  void SetUp() override {
    WriteTinyTum(folder_, {.camera = false});
    SetWarningListener([this](const std::string& warning) { warnings_.push_back(warning); });
  }
  void TearDown() override { SetWarningListener(nullptr); }

  SourceInfo Info(const SourceOptions& options = {}) const {
    return OpenSource(folder_.path(), options)->Info();
  }

  TempFolder folder_;
  std::vector<std::string> warnings_;
};

TEST_F(CalibrationBeside, OfAnotherToolIsUsedAndTold) {
  for (
      const auto& [name, text] : std::vector<std::pair<std::string, std::string>>{
          {"camera_info.yaml", kRos},
          {"cameras.txt", Colmap(60)},
          {"camchain-walk.yaml", Kalibr(60)},
          {"walk-camchain.yaml", Kalibr(60)},
          {"transforms.json",
           R"({"fl_x": 60, "fl_y": 61, "cx": 31.5, "cy": 24.5, "w": 64, "h": 48, "frames": []})"}}) {
    SCOPED_TRACE(name);
    const std::string file = folder_.Write(name, text);
    const SourceInfo info = Info();
    EXPECT_FALSE(info.camera_guessed);
    EXPECT_DOUBLE_EQ(info.camera.fx, 60);
    EXPECT_DOUBLE_EQ(info.camera.cy, 24);
    EXPECT_THAT(info.told, HasSubstr("found beside the recording: " + file));
    std::filesystem::remove(file);
  }
  EXPECT_TRUE(Info().camera_guessed);
  EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(CalibrationBeside, AlidadesOwnAndTheUsersHavePriority) {
  folder_.Write("camera_info.yaml", kRos);
  folder_.Write("cameras.txt", Colmap(66));  // disagrees
  SourceOptions options;
  options.fov_degrees = 60;
  EXPECT_THAT(Info(options).told, Not(HasSubstr("beside")));
  options = {};
  options.camera_file = folder_.Write("chosen.yaml", kOwn);
  EXPECT_DOUBLE_EQ(Info(options).camera.fx, 50);
  folder_.Write("camera.yaml", kOwn);
  EXPECT_DOUBLE_EQ(Info().camera.fx, 50);
  EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(CalibrationBeside, SeveralMustAgree) {
  const std::string ros = folder_.Write("camera_info.yaml", kRos);
  const std::string colmap = folder_.Write("cameras.txt", Colmap(60.05));
  EXPECT_NEAR(Info().camera.fx, 60, 0.06);
  folder_.Write("cameras.txt", Colmap(63));  // 32 pixels × 3 / 60 at the border
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { Info(); }),
              AllOf(HasSubstr("disagree by 1.6"), HasSubstr(ros + ", " + colmap),
                    HasSubstr("--camera " + ros)));
}

TEST_F(CalibrationBeside, ThatCannotBeUsedIsAWarning) {
  folder_.Write("calibration.json", R"({"speed": 3})");
  folder_.Write("cameras.txt", "1 PINHOLE 64 64 60 61 32 32\n");
  EXPECT_TRUE(Info().camera_guessed);
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("calibration.json: is not a calibration"),
                                     HasSubstr("another aspect ratio")));
}

TEST_F(CalibrationBeside, WithoutARateGetsThatOfTheTimes) {
  folder_.Write("camera_info.yaml", kRos);
  EXPECT_NEAR(Info().camera.fps, 1, 1e-9);  // frames of TinyTum are a second apart
  SourceOptions options;
  options.camera_file = folder_.Write("chosen.yaml", kOwn);
  EXPECT_NEAR(Info(options).camera.fps, 1, 1e-9);
}

TEST(CalibrationBesideImages, WithoutARateIsSaidToBeAssumed) {
  const TempFolder folder;
  for (const int i : {1, 2}) WriteImage(folder / (std::to_string(i) + ".png"), TinyImage(i));
  folder.Write("camera_info.yaml", kRos);
  const auto assumed = OpenSource(folder.path());
  EXPECT_TRUE(assumed->Info().fps_assumed);
  assumed->Next();
  EXPECT_DOUBLE_EQ(assumed->Next()->time, 1 / 30.0);
  folder.Write("camera.yaml", std::string(kOwn) + "fps: 10\n");
  SourceOptions options;
  options.camera_file = folder.Write("chosen.yaml", kOwn);  // has no rate either
  const auto known = OpenSource(folder.path(), options);
  EXPECT_FALSE(known->Info().fps_assumed);
  known->Next();
  EXPECT_DOUBLE_EQ(known->Next()->time, 0.1);
}

}  // namespace
}  // namespace alidade::calibration_beside_test
