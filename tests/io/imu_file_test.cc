// Inertial readings in a file of their own, and their sensor in camera.yaml.
#include "alidade/io/files/imu_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "alidade/base/log.h"
#include "alidade/io/files/camera_file.h"
#include "alidade/io/files/open_source.h"
#include "support/expect_error.h"
#include "support/tiny_recording.h"

namespace alidade::imu_file_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr char kCamera[] =
    "model: pinhole\nwidth: 64\nheight: 48\nfx: 60\nfy: 60\ncx: 31.5\ncy: 23.5\nfps: 20\n";

// Warnings while it exists.
class Heard {
 public:
  Heard() {
    SetWarningListener([this](const std::string& text) { all.push_back(text); });
  }
  ~Heard() { SetWarningListener(nullptr); }
  std::vector<std::string> all;
};

// `fall`: the acceleration along y, m/s².
std::string Readings(double begin, double end, double fall = 9.81) {
  std::string text = "t [s],wx [rad/s],wy,wz,ax [m/s^2],ay,az\n";
  for (int i = 0; begin + 0.005 * i < end; ++i)
    text += std::to_string(begin + 0.005 * i) + ",0.1," + std::to_string(0.01 * (i % 7)) + ",0.2," +
            std::to_string(0.1 * (i % 3)) + "," + std::to_string(fall) + ",0.5\n";
  return text;
}

// Five images at 20 Hz from 0 s on.
void WriteImages(const TempFolder& folder) {
  for (int i = 0; i < 5; ++i)
    WriteImage(folder / ("image" + std::to_string(i) + ".png"), TinyImage(i));
}

TEST(ImuFile, BesideTheImagesIsUsed) {
  const TempFolder folder;
  WriteImages(folder);
  folder.Write("camera.yaml", std::string(kCamera) +
                                  "imu:\n  T_camera_imu: [0, -1, 0, 0.1, 1, 0, 0, 0.2, 0, 0, 1, "
                                  "0.3, 0, 0, 0, 1]\n  gyro_noise: 2e-4\n  time_offset: 0.03\n");
  folder.Write("imu.csv", Readings(-1, 2));
  const Heard heard;
  const auto source = OpenSource(folder.path());
  ASSERT_TRUE(source->Info().imu);
  const ImuModel imu = *source->Info().imu;
  EXPECT_TRUE(imu.rotation_known && imu.translation_known && imu.time_offset_known);
  EXPECT_EQ(imu.T_camera_imu.t, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(imu.T_camera_imu.R(1, 0), 1);
  EXPECT_EQ(imu.noise.gyro, 2e-4);
  EXPECT_EQ(imu.noise.accel, ImuNoise().accel);
  EXPECT_NEAR(imu.rate, 200, 1e-3);
  // The image of 0.1 s was taken at 0.13 s on the clock of the readings.
  EXPECT_NEAR(source->Next()->imu.front().time, 0.03 - kImuAround, 0.006);
  EXPECT_TRUE(source->Seek(2));
  const auto frame = source->Next();
  EXPECT_NEAR(frame->imu.front().time, 0.13 - kImuAround, 0.006);
  EXPECT_NEAR(frame->imu.back().time, 0.13 + kImuAround, 0.006);
  EXPECT_THAT(heard.all, IsEmpty());
}

TEST(ImuFile, WithoutABlockTheSensorIsUnknown) {
  const TempFolder folder;
  WriteImages(folder);
  folder.Write("my.txt", Readings(0, 2));
  const auto source = OpenSource(folder.path(), {.imu = folder / "my.txt"});
  ASSERT_TRUE(source->Info().imu);
  EXPECT_FALSE(source->Info().imu->rotation_known || source->Info().imu->translation_known ||
               source->Info().imu->time_offset_known);
  EXPECT_THAT(MessageOf(ErrorKind::kInput,
                        [&] { OpenSource(folder.path(), {.imu = folder / "none.csv"}); }),
              HasSubstr("none.csv"));
}

TEST(ImuFile, ReadingsThatCannotBeAreLeftOut) {
  const TempFolder folder;
  WriteImages(folder);
  folder.Write("imu.csv", Readings(0, 2, 0.1));
  {
    const Heard heard;
    const auto source = OpenSource(folder.path());
    EXPECT_FALSE(source->Info().imu);
    EXPECT_TRUE(source->Next()->imu.empty());
    EXPECT_THAT(heard.all, ElementsAre(HasSubstr("lack gravity")));
  }
  folder.Write("imu.csv", "a picture of a cat\n");
  {
    const Heard heard;
    EXPECT_FALSE(OpenSource(folder.path())->Info().imu);
    EXPECT_THAT(heard.all, ElementsAre(HasSubstr("left out")));
  }
  folder.Write("imu.csv", Readings(5000, 5002));
  const Heard heard;
  EXPECT_TRUE(OpenSource(folder.path())->Next()->imu.empty());
  EXPECT_THAT(heard.all, ElementsAre(HasSubstr("of another time than the images")));
}

TEST(ImuFile, BlockOfTheCameraFileIsChecked) {
  const auto message = [](const std::string& block) {
    return MessageOf(ErrorKind::kInput, [&] { ParseCameraFile(kCamera + block, "camera.yaml"); });
  };
  EXPECT_THAT(message("imu:\n  gyro_nose: 1e-4\n"),
              testing::AllOf(HasSubstr("camera.yaml:10"), HasSubstr("did you mean 'gyro_noise'")));
  EXPECT_THAT(message("imu: 7\n"), HasSubstr("names and values"));
  EXPECT_THAT(message("imu:\n  T_camera_imu: [1, 0, 0]\n"), HasSubstr("4x4"));
  EXPECT_THAT(message("imu:\n  accel_noise: -1\n"), HasSubstr("positive"));
  EXPECT_THAT(message("imu:\n  time_offset: 30\n"), HasSubstr("in seconds"));
}

}  // namespace
}  // namespace alidade::imu_file_test
