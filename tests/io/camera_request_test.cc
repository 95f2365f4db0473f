#include "alidade/io/camera/camera_request.h"

#include <gtest/gtest.h>

#include "alidade/io/camera/camera_modes.h"
#include "support/expect_error.h"

namespace alidade::camera_request_test {
namespace {

TEST(CameraRequest, ReadsItsOptions) {
  const CameraRequest request = ParseCameraSource(
      "camera:3?size=1280x720&fps=59.94&format=mjpeg&exposure=8ms&focus=-5&stereo=top-bottom");
  EXPECT_EQ(request.device, "/dev/video3");
  EXPECT_EQ(request.size, cv::Size(1280, 720));
  EXPECT_EQ(request.fps, 59.94);
  EXPECT_EQ(request.format, "MJPEG");
  EXPECT_DOUBLE_EQ(*request.exposure, 0.008);
  EXPECT_EQ(request.focus, -5);
  EXPECT_EQ(request.stereo, StereoLayout::kTopBottom);
  EXPECT_DOUBLE_EQ(*ParseCameraSource("camera:0?exposure=500us").exposure, 0.0005);
  EXPECT_FALSE(ParseCameraSource("camera:0?exposure=auto").exposure);
}

TEST(CameraRequest, ADeviceFileIsTheSameCamera) {
  EXPECT_TRUE(IsCameraSource("/dev/video12?fps=30"));
  EXPECT_EQ(ParseCameraSource("/dev/video12?fps=30").device, "/dev/video12");
  EXPECT_EQ(ParseCameraSource("camera:12").device, "/dev/video12");
  EXPECT_FALSE(IsCameraSource("videos/dev/video1.mp4"));
}

TEST(CameraRequest, RefusesWhatCannotBe) {
  for (const char* source : {"camera:",
                             "camera:x",
                             "camera:-1",
                             "camera:1000",
                             "/dev/video",
                             "camera:0?size=640",
                             "camera:0?size=640x0",
                             "camera:0?size=640.5x480",
                             "camera:0?size=99999x480",
                             "camera:0?fps=0",
                             "camera:0?fps=nan",
                             "camera:0?fps=1e9",
                             "camera:0?format=H264",
                             "camera:0?exposure=8",
                             "camera:0?exposure=0ms",
                             "camera:0?exposure=11s",
                             "camera:0?exposure=ms",
                             "camera:0?focus=auto",
                             "camera:0?focus=1.5",
                             "camera:0?stereo=yes",
                             "camera:0?colour=1",
                             "camera:0?fps"}) {
    EXPECT_THAT(MessageOf(ErrorKind::kUsage, [&] { ParseCameraSource(source); }),
                testing::HasSubstr("camera"));
  }
}

CameraMode Mode(const char* format, int width, int height, double fps) {
  return {FindPixelFormat(std::string_view(format)), {width, height}, fps};
}

TEST(CameraModes, ChoosesVgaAtThirtyInTheCheapestFormat) {
  const std::vector<CameraMode> modes = {Mode("MJPEG", 1920, 1080, 30), Mode("MJPEG", 640, 480, 60),
                                         Mode("MJPEG", 640, 480, 30),   Mode("YUYV", 640, 480, 30),
                                         Mode("YUYV", 1280, 720, 10),   Mode("YUYV", 320, 240, 30)};
  EXPECT_EQ(ChooseMode(modes, {}), &modes[3]);
  CameraRequest request;
  request.fps = 60;
  EXPECT_EQ(ChooseMode(modes, request), &modes[1]);
  request = {};
  request.size = {1280, 720};
  EXPECT_EQ(ChooseMode(modes, request), &modes[4]);
  request = {};
  request.format = "MJPEG";
  EXPECT_EQ(ChooseMode(modes, request), &modes[2]);
  request.size = {1280, 720};
  EXPECT_EQ(ChooseMode(modes, request), nullptr);
}

TEST(CameraModes, ARateOfThirtyComesBeforeTheSize) {
  const std::vector<CameraMode> modes = {Mode("YUYV", 640, 480, 15), Mode("GREY", 1280, 800, 60),
                                         Mode("GREY", 640, 400, 120)};
  EXPECT_EQ(ChooseMode(modes, {}), &modes[2]);
}

TEST(CameraModes, APairIsTwiceAsLarge) {
  const std::vector<CameraMode> modes = {Mode("YUYV", 640, 240, 30), Mode("YUYV", 1280, 480, 30),
                                         Mode("YUYV", 2560, 720, 30)};
  CameraRequest request;
  request.stereo = StereoLayout::kSideBySide;
  EXPECT_EQ(ChooseMode(modes, request), &modes[1]);
}

}  // namespace
}  // namespace alidade::camera_request_test
