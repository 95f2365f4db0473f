#include "alidade/io/files/camera_file.h"

#include <gtest/gtest.h>

#include "alidade/io/files/open_source.h"
#include "support/expect_error.h"
#include "support/tiny_recording.h"

namespace alidade::camera_file_test {
namespace {

using testing::HasSubstr;

const char kGood[] = "model: pinhole\nwidth: 64\nheight: 48\nfx: 60\nfy: 61\ncx: 31\ncy: 24\n";

Calibration Read(const std::string& text) {
  const TempFolder folder;
  return ReadCameraFile(folder.Write("camera.yaml", text));
}

TEST(CameraFile, HoldsWhatItSays) {
  const Calibration c = Read(
      std::string("%YAML:1.0\n---\n") + kGood +
      "distortion: [0.1, -0.2, 0.003, 0.004, 0.5]\nfps: 25\ndepth_factor: 1000\nbaseline: 0.12\n");
  EXPECT_EQ(c.left.lens, Lens::kPinhole);
  EXPECT_EQ(c.left.width, 64);
  EXPECT_EQ(c.left.fy, 61);
  EXPECT_EQ(c.left.distortion[4], 0.5);
  EXPECT_EQ(c.fps, 25);
  EXPECT_EQ(c.depth_factor, 1000);
  EXPECT_EQ(c.baseline, 0.12);
  EXPECT_FALSE(Read(kGood).depth_factor);
}

TEST(CameraFile, HoldsHowLongTheShutterRolls) {
  EXPECT_FALSE(Read(kGood).readout);
  EXPECT_EQ(Read(std::string(kGood) + "readout: 0\n").readout, (std::array{0.0, 0.0}));
  EXPECT_EQ(Read(std::string(kGood) + "readout: 0.02\n").readout, (std::array{0.0, 0.02}));
  EXPECT_EQ(Read(std::string(kGood) + "readout: [-0.01, 0]\n").readout, (std::array{-0.01, 0.0}));
  EXPECT_THAT(
      MessageOf(ErrorKind::kInput, [] { Read(std::string(kGood) + "readout: [1, 2, 3]\n"); }),
      HasSubstr("readout"));
  Camera camera = Camera::FromFieldOfView(64, 48, 60);
  for (const std::array<double, 2>& readout : {std::array{0.0, 0.017}, std::array{-0.01, 0.0}}) {
    camera.readout = readout;
    EXPECT_EQ(ParseCameraFile(FormatCameraFile(camera), "x").readout, readout);
  }
  camera.readout = {};
  EXPECT_FALSE(ParseCameraFile(FormatCameraFile(camera), "x").readout);
  camera.readout_known = true;
  EXPECT_EQ(ParseCameraFile(FormatCameraFile(camera), "x").readout, (std::array{0.0, 0.0}));
}

TEST(CameraFile, HoldsASecondCamera) {
  const std::string right =
      "right: {model: fisheye, width: 64, height: 48, fx: 50, fy: 51, cx: 30, cy: 20, distortion: "
      "[1, 2, 3, 4],\n"
      "  T_left_right: [[1, 0, 0, 0.2], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}\n";
  const Calibration c = Read(kGood + right);
  ASSERT_TRUE(c.right);
  EXPECT_EQ(c.right->lens, Lens::kFisheye);
  EXPECT_EQ(c.T_left_right.t.x(), 0.2);
  EXPECT_THAT(
      MessageOf(ErrorKind::kInput, [&] { Read(kGood + std::string("baseline: 1\n") + right); }),
      HasSubstr("either `baseline`"));
}

TEST(CameraFile, MistakesAreNamedWithTheirLine) {
  const auto message = [](const std::string& text) {
    return MessageOf(ErrorKind::kInput, [&] { Read(text); });
  };
  const std::string good = kGood;
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_THAT(message(with("fx: 60\n", "")), HasSubstr("`fx` is missing"));
  EXPECT_THAT(message(with("model: pinhole\n", "")), HasSubstr("`model` is missing"));
  EXPECT_THAT(message(with("fx: 60", "fx: -60")),
              HasSubstr("camera.yaml:4: `fx` must be positive, not `-60`"));
  EXPECT_THAT(message(with("cy: 24", "cy: .nan")),
              HasSubstr("camera.yaml:7: `cy` must be a finite number"));
  EXPECT_THAT(message(with("cy: 24", "cy: nan")), HasSubstr("camera.yaml:7"));
  EXPECT_THAT(message(with("width: 64", "width: 64.5")),
              HasSubstr("camera.yaml:2: `width` must be a whole number"));
  EXPECT_THAT(message(with("height: 48", "height: 0")), HasSubstr("camera.yaml:3"));
  EXPECT_THAT(message(with("pinhole", "pinole")), HasSubstr("pinhole or fisheye"));
  EXPECT_THAT(message(good + "distortion: [1, 2]\n"), HasSubstr("camera.yaml:8: `distortion`"));
  EXPECT_THAT(message(good + "distortion: [1, 2, x, 4]\n"), HasSubstr("`x`"));
  EXPECT_THAT(message(good + "fps: 0\n"), HasSubstr("camera.yaml:8"));
  EXPECT_THAT(message(good + "depth_factor: -1\n"), HasSubstr("camera.yaml:8"));
  EXPECT_THAT(message(good + "right: {model: pinhole}\n"), HasSubstr("`width` is missing"));
  EXPECT_THAT(message("just words\n"), HasSubstr("camera.yaml"));
  EXPECT_THAT(message(""), HasSubstr("camera.yaml"));
  EXPECT_THAT(message("a: [1, 2\nb: 3\n"), HasSubstr("camera.yaml:"));
}

TEST(CameraFile, NamesThatMeanNothingAreWarnedOf) {
  WarningCatcher warnings;
  Read(std::string(kGood) + "distorsion: [1, 2, 3, 4]\n");
  EXPECT_THAT(warnings.text(), HasSubstr("camera.yaml:8: `distorsion` is not known here"));
}

TEST(CameraFile, FisheyeImagesBecomePinholes) {
  const TempFolder folder;
  WriteTinyTum(folder);
  folder.Write("camera.yaml",
               "model: fisheye\nwidth: 64\nheight: 48\nfx: 30\nfy: 30\ncx: 31.5\ncy: 23.5\n"
               "distortion: [0.01, 0, 0, 0]\ndepth_factor: 1000\n");
  const auto source = OpenSource(folder.path());
  EXPECT_FALSE(source->Info().camera.HasDistortion());
  const auto frame = source->Next();
  EXPECT_EQ(frame->image.size(), cv::Size(64, 48));
  EXPECT_NE(cv::norm(frame->image, TinyImage(0), cv::NORM_INF), 0);
  // Depth is never interpolated: it has a single value everywhere.
  EXPECT_EQ(cv::norm(frame->depth, TinyDepth(0), cv::NORM_INF), 0);
}

TEST(CameraFile, WithNeitherBaselineNorRightMakesNoStereo) {
  const TempFolder folder;
  folder.Folder("image_0");
  folder.Folder("image_1");
  for (const std::string cam : {"image_0", "image_1"})
    WriteImage(folder / (cam + "/0.png"), TinyImage(0));
  folder.Write("times.txt", "0\n");
  const std::string camera = folder.Write("mono.yaml", kGood);
  EXPECT_THAT(
      MessageOf(ErrorKind::kInput, [&] { OpenSource(folder.path(), {.camera_file = camera}); }),
      HasSubstr("baseline"));
  const std::string stereo = folder.Write("stereo.yaml", std::string(kGood) + "baseline: 0.5\n");
  EXPECT_EQ(OpenSource(folder.path(), {.camera_file = stereo})->Info().camera.baseline, 0.5);
}

}  // namespace
}  // namespace alidade::camera_file_test
