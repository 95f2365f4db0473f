#include <gtest/gtest.h>

#include "alidade/io/files/open_source.h"
#include "support/expect_error.h"
#include "support/tiny_recording.h"

namespace alidade::kitti_source_test {
namespace {

using testing::HasSubstr;

void WriteTinyKitti(const TempFolder& folder, int frames, bool right = true) {
  std::string times;
  for (int cam = 0; cam < (right ? 2 : 1); ++cam) folder.Folder("image_" + std::to_string(cam));
  for (int i = 0; i < frames; ++i) {
    times += std::to_string(i) + ".000000e-01\n";
    for (int cam = 0; cam < (right ? 2 : 1); ++cam) {
      WriteImage(folder / ("image_" + std::to_string(cam) + "/00000" + std::to_string(i) + ".png"),
                 TinyImage(10 * i + cam));
    }
  }
  folder.Write("times.txt", times);
  folder.Write(
      "calib.txt",
      "P0: 7.18e+01 0 31.5 0 0 71.8 23.5 0 0 0 1 0\nP1: 71.8 0 31.5 -38.5 0 71.8 23.5 0 0 0 1 0\n");
}

TEST(KittiSource, ReadsThePairItsTimesAndItsBaseline) {
  const TempFolder folder;
  WriteTinyKitti(folder, 3);
  const auto source = OpenSource(folder.path());
  EXPECT_EQ(source->Info().kind, "kitti");
  EXPECT_EQ(source->Info().sensor, Sensor::kStereo);
  EXPECT_DOUBLE_EQ(source->Info().camera.fx, 71.8);
  EXPECT_DOUBLE_EQ(source->Info().camera.bf(), 38.5);
  for (int i = 0; i < 3; ++i) {
    const auto frame = source->Next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->stamp, std::to_string(i) + ".000000e-01");
    EXPECT_DOUBLE_EQ(frame->time, 0.1 * i);
    EXPECT_EQ(cv::norm(frame->image, TinyImage(10 * i), cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(frame->right, TinyImage(10 * i + 1), cv::NORM_INF), 0);
  }
  EXPECT_FALSE(source->Next());
}

TEST(KittiSource, WithOneCameraIsMono) {
  const TempFolder folder;
  WriteTinyKitti(folder, 3, false);
  const auto source = OpenSource(folder.path());
  EXPECT_EQ(source->Info().sensor, Sensor::kMono);
  EXPECT_EQ(source->Info().camera.baseline, 0);
  EXPECT_TRUE(source->Next()->right.empty());
}

TEST(KittiSource, CountsOfTimesAndImagesMayDiffer) {
  const TempFolder folder;
  WriteTinyKitti(folder, 3);
  folder.Write("times.txt", "0\n0.1\n");
  WarningCatcher warnings;
  EXPECT_EQ(OpenSource(folder.path())->Info().frames, 2);
  EXPECT_THAT(warnings.text(), HasSubstr("2 times for 3 images"));
}

TEST(KittiSource, AMissingImageLeavesTheOthersTheirTimes) {
  const TempFolder folder;
  WriteTinyKitti(folder, 6);
  for (const char* name : {"image_0/000002.png", "image_1/000002.png", "image_0/000003.png"})
    std::filesystem::remove(folder / name);
  WarningCatcher warnings;
  const auto source = OpenSource(folder.path());
  EXPECT_THAT(warnings.text(), HasSubstr("6 times for 4 images: 2 are missing by their numbers"));
  EXPECT_EQ(source->Info().frames, 4);
  for (const int i : {0, 1, 4, 5}) {
    const auto frame = source->Next();
    ASSERT_TRUE(frame);
    EXPECT_DOUBLE_EQ(frame->time, 0.1 * i);
    EXPECT_EQ(cv::norm(frame->image, TinyImage(10 * i), cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(frame->right, TinyImage(10 * i + 1), cv::NORM_INF), 0);
  }
  EXPECT_FALSE(source->Next());
}

// Numbers from 1: the last would be beyond the list if the first time were that of number 0.
TEST(KittiSource, NumbersMayBeginAtOne) {
  const TempFolder folder;
  WriteTinyKitti(folder, 5, false);
  folder.Write("times.txt", "0\n0.1\n0.2\n0.3\n");
  for (const char* name : {"image_0/000000.png", "image_0/000002.png"})
    std::filesystem::remove(folder / name);
  const auto source = OpenSource(folder.path());
  for (const int i : {1, 3, 4}) {
    const auto frame = source->Next();
    ASSERT_TRUE(frame);
    EXPECT_DOUBLE_EQ(frame->time, 0.1 * (i - 1));
    EXPECT_EQ(cv::norm(frame->image, TinyImage(10 * i), cv::NORM_INF), 0);
  }
}

TEST(KittiSource, NamesThatAreNoNumbersArePairedInOrder) {
  const TempFolder folder;
  WriteTinyKitti(folder, 4, false);
  for (int i = 0; i < 3; ++i)
    std::filesystem::rename(folder / ("image_0/00000" + std::to_string(i) + ".png"),
                            folder / ("image_0/frame" + std::to_string(i) + ".png"));
  std::filesystem::remove(folder / "image_0/000003.png");
  WarningCatcher warnings;
  const auto source = OpenSource(folder.path());
  EXPECT_THAT(warnings.text(), HasSubstr("4 times for 3 images: frames without one"));
  EXPECT_EQ(source->Info().frames, 3);
}

TEST(KittiSource, BadCalibrationsAreNamed) {
  const TempFolder folder;
  WriteTinyKitti(folder, 2);
  const auto message = [&](const std::string& calib) {
    folder.Write("calib.txt", calib);
    return MessageOf(ErrorKind::kInput, [&] { OpenSource(folder.path()); });
  };
  EXPECT_THAT(message("P2: 1\n"), HasSubstr("`P0:` is missing"));
  EXPECT_THAT(message(",\n"), HasSubstr("`P0:` is missing"));  // a line without fields
  EXPECT_THAT(message("P0: 1 2 3\n"), HasSubstr("calib.txt:1: P0 needs 12 numbers"));
  EXPECT_THAT(message("P0: nan 0 31.5 0 0 71.8 23.5 0 0 0 1 0\n"), HasSubstr("`nan`"));
  EXPECT_THAT(message("P0: -5 0 31.5 0 0 71.8 23.5 0 0 0 1 0\n"), HasSubstr("positive"));
  EXPECT_THAT(message("P0: 71.8 0 31.5 0 0 71.8 23.5 0 0 0 1 0\n"), HasSubstr("baseline"));
}

}  // namespace
}  // namespace alidade::kitti_source_test
