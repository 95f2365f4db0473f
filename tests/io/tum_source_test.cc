#include <gtest/gtest.h>

#include "alidade/io/files/file.h"
#include "alidade/io/files/open_source.h"
#include "support/expect_error.h"
#include "support/tiny_recording.h"

namespace alidade::tum_source_test {
namespace {

std::vector<SourceFrame> AllFrames(FrameSource& source) {
  std::vector<SourceFrame> frames;
  while (auto frame = source.Next()) frames.push_back(*frame);
  return frames;
}

TEST(TumSource, GivesImagesDepthAndStampsAsRecorded) {
  const TempFolder folder;
  WriteTinyTum(folder);
  const auto source = OpenSource(folder.path());
  EXPECT_EQ(source->Info().kind, "tum");
  EXPECT_EQ(source->Info().sensor, Sensor::kRgbd);
  EXPECT_EQ(source->Info().frames, 5);
  EXPECT_EQ(source->Info().camera.fx, 60);
  EXPECT_EQ(source->Info().camera.depth_factor, 1000);
  EXPECT_FALSE(source->Info().camera_guessed);
  const auto frames = AllFrames(*source);
  ASSERT_EQ(frames.size(), 5u);
  for (int i = 0; i < 5; ++i) {
    const SourceFrame& frame = frames[static_cast<size_t>(i)];
    EXPECT_EQ(frame.number, i);
    EXPECT_EQ(frame.stamp, TinyStamp(i));
    EXPECT_DOUBLE_EQ(frame.time, 100.5 + i);
    EXPECT_EQ(cv::norm(frame.image, TinyImage(i), cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(frame.depth, TinyDepth(i), cv::NORM_INF), 0);
  }
}

TEST(TumSource, DepthIsTheNearestInTimeOneToOne) {
  const TempFolder folder;
  WriteTinyTum(folder, {.frames = 4});
  // Frames 1 and 2 are both near depth 1, frame 2 nearer; no depth is near frame 3 (0.02 s is too
  // far).
  folder.Write("rgb.txt",
               "1.000 rgb/100.500000.png\n1.030 rgb/101.500000.png\n1.041 "
               "rgb/102.500000.png\n1.100 rgb/103.500000.png\n");
  folder.Write(
      "depth.txt",
      "1.010 depth/100.500000.png\n1.040 depth/101.500000.png\n1.125 depth/102.500000.png\n");
  WarningCatcher warnings;
  const auto frames = AllFrames(*OpenSource(folder.path()));
  ASSERT_EQ(frames.size(), 4u);
  EXPECT_EQ(frames[0].depth.at<uint16_t>(0, 0), 1000);
  EXPECT_TRUE(frames[1].depth.empty());
  EXPECT_EQ(frames[2].depth.at<uint16_t>(0, 0), 1001);
  EXPECT_TRUE(frames[3].depth.empty());
  EXPECT_FALSE(frames[3].image.empty());
  EXPECT_THAT(warnings.text(), testing::HasSubstr("2 of 4 frames have no depth"));
}

TEST(TumSource, WithoutDepthIsMono) {
  const TempFolder folder;
  WriteTinyTum(folder, {.depth = false});
  EXPECT_EQ(OpenSource(folder.path())->Info().sensor, Sensor::kMono);
  EXPECT_EQ(OpenSource(folder.path())->Info().camera.depth_factor, 0);
  MessageOf(ErrorKind::kUsage, [&] { OpenSource(folder.path(), {.sensor = Sensor::kRgbd}); });
  MessageOf(ErrorKind::kUsage, [&] { OpenSource(folder.path(), {.sensor = Sensor::kStereo}); });
}

TEST(TumSource, DepthFactorOfZeroMeansNoDepth) {
  const TempFolder folder;
  WriteTinyTum(folder);
  const std::string camera = ReadFile(folder / "camera.yaml");
  folder.Write("camera.yaml", camera.substr(0, camera.find("depth_factor")) + "depth_factor: 0\n");
  EXPECT_EQ(OpenSource(folder.path())->Info().sensor, Sensor::kMono);
  MessageOf(ErrorKind::kUsage, [&] { OpenSource(folder.path(), {.sensor = Sensor::kRgbd}); });
  folder.Write("camera.yaml", camera.substr(0, camera.find("depth_factor")));
  EXPECT_EQ(OpenSource(folder.path())->Info().camera.depth_factor, 5000);
}

TEST(TumSource, WithoutCameraFileGuesses) {
  const TempFolder folder;
  WriteTinyTum(folder, {.camera = false});
  WarningCatcher warnings;
  const SourceInfo info = OpenSource(folder.path())->Info();
  EXPECT_TRUE(info.camera_guessed);
  EXPECT_NEAR(info.camera.fx, 32 / std::tan(33 * M_PI / 180), 1e-9);
  EXPECT_EQ(info.camera.depth_factor, 5000);
  EXPECT_FALSE(OpenSource(folder.path(), {.fov_degrees = 90})->Info().camera_guessed);
  EXPECT_NEAR(OpenSource(folder.path(), {.fov_degrees = 90})->Info().camera.fx, 32, 1e-9);
  const SourceInfo rough =
      OpenSource(folder.path(), {.fov_degrees = 90, .fov_rough = true})->Info();
  EXPECT_TRUE(rough.camera_guessed);
  EXPECT_NEAR(rough.camera.fx, 32, 1e-9);
}

TEST(TumSource, BadImagesAreSkippedAndTheRestGoesOn) {
  const TempFolder folder;
  WriteTinyTum(folder, {.frames = 7});
  const auto image = [&](int i) { return "rgb/" + TinyStamp(i) + ".png"; };
  const std::string bytes = ReadFile(folder / image(1));
  folder.Write(image(1), bytes.substr(0, bytes.size() / 2));
  folder.Write(image(2), "");
  WriteImage(folder / image(3), TinyImage(3, 32, 24));
  std::filesystem::remove(folder / image(4));
  folder.Write("depth/" + TinyStamp(5) + ".png", "");
  WarningCatcher warnings;
  const auto frames = AllFrames(*OpenSource(folder.path()));
  ASSERT_EQ(frames.size(), 7u);
  const std::string expected[] = {"", "truncated", "is empty", "32x24", "No such file", "", ""};
  for (int i = 0; i < 7; ++i) {
    const SourceFrame& frame = frames[static_cast<size_t>(i)];
    EXPECT_EQ(frame.number, i);
    EXPECT_EQ(frame.image.empty(), !expected[i].empty()) << i;
    EXPECT_EQ(frame.problem.empty(), expected[i].empty()) << i;
    EXPECT_THAT(frame.problem, testing::HasSubstr(expected[i]));
  }
  EXPECT_TRUE(frames[5].depth.empty());
  EXPECT_THAT(frames[5].incomplete, testing::HasSubstr("depth/" + TinyStamp(5)));
  EXPECT_EQ(warnings.text(), "");
}

TEST(TumSource, TimesOutOfOrderAreSortedRepeatsAndNonsenseSkipped) {
  const TempFolder folder;
  WriteTinyTum(folder, {.depth = false});
  folder.Write("rgb.txt",
               "104.5 rgb/104.500000.png\n100.5 rgb/100.500000.png\nnan rgb/101.500000.png\n"
               "100.5 rgb/102.500000.png\nsoon rgb/103.500000.png\n103.5\n");
  WarningCatcher warnings;
  const auto frames = AllFrames(*OpenSource(folder.path()));
  ASSERT_EQ(frames.size(), 6u);
  std::vector<std::string> good;
  std::string problems;
  for (const SourceFrame& frame : frames) {
    EXPECT_EQ(frame.image.empty(), !frame.problem.empty());
    EXPECT_TRUE(std::isfinite(frame.time));
    if (frame.problem.empty()) good.push_back(frame.stamp);
    problems += frame.problem + "\n";
  }
  EXPECT_EQ(good, (std::vector<std::string>{"100.5", "104.5"}));
  EXPECT_THAT(problems, testing::HasSubstr("rgb.txt:3: `nan` is not a time stamp"));
  EXPECT_THAT(problems, testing::HasSubstr("rgb.txt:5: `soon` is not a time stamp"));
  EXPECT_THAT(problems, testing::HasSubstr("rgb.txt:6: the file name after"));
  EXPECT_THAT(problems,
              testing::HasSubstr("102.500000.png has the time stamp of the previous frame"));
  EXPECT_THAT(warnings.text(), testing::HasSubstr("not in order"));
}

TEST(TumSource, FirstAndLastAreFrameNumbersBothIncluded) {
  const TempFolder folder;
  WriteTinyTum(folder);
  const auto source = OpenSource(folder.path(), {.first = 1, .last = 3});
  EXPECT_EQ(source->Info().frames, 3);
  const auto frames = AllFrames(*source);
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames.front().number, 1);
  EXPECT_EQ(frames.back().number, 3);
  EXPECT_EQ(AllFrames(*OpenSource(folder.path(), {.first = 4, .last = 99})).size(), 1u);
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { OpenSource(folder.path(), {.first = 5}); }),
              testing::HasSubstr("past the end"));
  MessageOf(ErrorKind::kUsage, [&] { OpenSource(folder.path(), {.first = 3, .last = 2}); });
}

TEST(TumSource, PathsThatAreNoRecordingSayWhy) {
  const TempFolder folder;
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { OpenSource(folder / "nowhere"); }),
              testing::HasSubstr("nowhere"));
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { OpenSource(folder.path()); }),
              testing::HasSubstr("empty folder"));
  folder.Write("notes.txt", "hello");
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { OpenSource(folder.path()); }),
              testing::AllOf(testing::HasSubstr("TUM"), testing::HasSubstr("EuRoC"),
                             testing::HasSubstr("KITTI")));
  folder.Write("rgb.txt", "# nothing\n");
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { OpenSource(folder.path()); }),
              testing::HasSubstr("lists nothing"));
}

TEST(TumSource, CameraForAnotherAspectRatioIsRefused) {
  const TempFolder folder;
  WriteTinyTum(folder);
  const std::string camera = folder.Write(
      "other.yaml", "model: pinhole\nwidth: 640\nheight: 400\nfx: 1\nfy: 1\ncx: 1\ncy: 1\n");
  EXPECT_THAT(
      MessageOf(ErrorKind::kInput, [&] { OpenSource(folder.path(), {.camera_file = camera}); }),
      testing::AllOf(testing::HasSubstr("other.yaml"), testing::HasSubstr("640x400"),
                     testing::HasSubstr("64x48")));
}

// Ten times the size: the camera is scaled, and the user is told.
TEST(TumSource, CameraForAnotherSizeIsScaled) {
  const TempFolder folder;
  WriteTinyTum(folder);
  const std::string camera = folder.Write("cameras.txt", "1 PINHOLE 640 480 600 610 320 240\n");
  const auto source = OpenSource(folder.path(), {.camera_file = camera});
  EXPECT_EQ(source->Info().camera.width, 64);
  EXPECT_NEAR(source->Info().camera.fx, 60, 1e-9);
  EXPECT_NEAR(source->Info().camera.cx, 31.5, 1e-9);
  EXPECT_THAT(source->Info().told, testing::HasSubstr("scaled to 64x48"));
}

TEST(TumSource, ReadsTheRealRecordings) {
  if (DataFolder().empty()) GTEST_SKIP() << "needs ALIDADE_DATA";
  const auto kitchen = OpenSource(DataFolder() + "/kitchen");
  EXPECT_EQ(kitchen->Info().frames, 600);
  EXPECT_EQ(kitchen->Info().name, "kitchen");
  const auto frame = kitchen->Next();
  EXPECT_EQ(frame->stamp, "1000.000000");
  EXPECT_EQ(frame->image.size(), cv::Size(640, 480));
  EXPECT_EQ(frame->depth.type(), CV_16UC1);
  const auto rpy = OpenSource(DataFolder() + "/fr1_rpy");
  EXPECT_EQ(rpy->Info().frames, 220);
  EXPECT_EQ(rpy->Info().camera.distortion[4], 1.163314);
  int without_depth = 0;
  while (const auto f = rpy->Next()) {
    EXPECT_EQ(f->problem, "");
    without_depth += f->depth.empty() ? 1 : 0;
  }
  EXPECT_EQ(without_depth, 0);
}

}  // namespace
}  // namespace alidade::tum_source_test
