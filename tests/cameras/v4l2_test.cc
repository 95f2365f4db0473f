// Cameras by Video4Linux, with the kernel's side played by fake_v4l2.cc.
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <cerrno>
#include <thread>

#include "alidade/io/camera/camera_source.h"
#include "alidade/io/camera/v4l2_camera.h"
#include "cameras/fake_v4l2.h"
#include "support/expect_error.h"
#include "support/temp_folder.h"

namespace alidade::v4l2_test {
namespace {

constexpr int kWidth = 64, kHeight = 48;

// Every pixel of image `i` has this level; those of the right half 100 more.
int LevelOf(size_t i) { return 20 + static_cast<int>(i % 100); }

std::string Picture(size_t i, uint32_t code) {
  std::string bytes;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      bytes += static_cast<char>(LevelOf(i) + (x >= kWidth / 2 ? 100 : 0));
      if (code == V4L2_PIX_FMT_YUYV) bytes += '\x80';
    }
  }
  return bytes;
}

std::shared_ptr<FakeCamera> MakeCamera(const std::string& name = "Camera A") {
  const auto camera = std::make_shared<FakeCamera>();
  camera->name = name;
  camera->bus = "usb-1";
  camera->modes = {{V4L2_PIX_FMT_YUYV, kWidth, kHeight, {100, 50}},
                   {V4L2_PIX_FMT_GREY, kWidth, kHeight, {100}},
                   {V4L2_PIX_FMT_H264, kWidth, kHeight, {100}}};
  camera->picture = Picture;
  return camera;
}

class V4l2 : public testing::Test {
 protected:
  ~V4l2() override { UnplugAll(); }
  static std::unique_ptr<LiveDevice> Open(const std::string& source) {
    return OpenV4l2Camera(ParseCameraSource(source));
  }
};

TEST_F(V4l2, ListsCamerasAndWhatTheyCan) {
  Plug(0, MakeCamera());
  const auto meta = MakeCamera("Metadata of A");
  meta->modes.clear();  // takes no pictures
  Plug(1, meta);
  const auto second = MakeCamera("Camera B");
  second->controls = {{V4L2_CID_EXPOSURE_ABSOLUTE, {1, 5000, 157}},
                      {V4L2_CID_FOCUS_AUTO, {0, 1, 1}},
                      {V4L2_CID_FOCUS_ABSOLUTE, {0, 250, 30}}};
  Plug(12, second);
  TheFakeBus().errors[5] = EACCES;
  std::vector<std::string> problems;
  const std::vector<CameraDevice> cameras = FindCameras(&problems);
  ASSERT_EQ(cameras.size(), 2u);
  EXPECT_EQ(cameras[0].path, "/dev/video0");
  EXPECT_EQ(cameras[0].name, "Camera A");
  ASSERT_EQ(cameras[0].modes.size(), 3u);
  EXPECT_EQ(NameOf(cameras[0].modes[1]), "64 x 48 YUYV at 50 per second");
  EXPECT_EQ(cameras[0].others, std::vector<std::string>{"H264"});
  EXPECT_EQ(cameras[1].path, "/dev/video12");
  EXPECT_EQ(cameras[1].controls,
            (std::vector<std::string>{"exposure 0.1 ms to 500 ms", "focus 0 to 250, automatic"}));
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_NE(problems[0].find("group `video`"), std::string::npos) << problems[0];
}

TEST_F(V4l2, GivesTheNewestPictureWithTheKernelsTime) {
  Plug(0, MakeCamera());
  const auto device = Open("camera:0?fps=50&format=YUYV");
  EXPECT_EQ(device->Told(), "Camera A, 64 x 48 YUYV at 50 per second");
  EXPECT_EQ(device->FramesPerSecond(), 50);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  LivePicture first, next;
  ASSERT_EQ(device->Take(1, true, first), LiveDevice::Taken::kPicture);
  const int level = first.image.at<uchar>(3, 3);
  EXPECT_GE(level, LevelOf(10));  // not the oldest
  EXPECT_EQ(first.color.type(), CV_8UC3);
  ASSERT_EQ(device->Take(1, false, next), LiveDevice::Taken::kPicture);
  const int later = next.image.at<uchar>(3, 3);
  EXPECT_GT(later, level);
  EXPECT_NEAR(next.time - first.time, (later - level) / 50.0, 1e-5);
  EXPECT_TRUE(next.color.empty());
}

TEST_F(V4l2, HoldsExposureAndFocusAndSetsThemBack) {
  const auto camera = MakeCamera();
  camera->controls = {{V4L2_CID_EXPOSURE_AUTO, {0, 3, V4L2_EXPOSURE_APERTURE_PRIORITY}},
                      {V4L2_CID_EXPOSURE_AUTO_PRIORITY, {0, 1, 1}},
                      {V4L2_CID_EXPOSURE_ABSOLUTE, {1, 5000, 157}},
                      {V4L2_CID_FOCUS_AUTO, {0, 1, 1}},
                      {V4L2_CID_FOCUS_ABSOLUTE, {0, 250, 30}}};
  Plug(0, camera);
  const auto value = [&](uint32_t control) { return camera->controls.at(control).value; };
  {
    const auto device = Open("camera:0?exposure=8ms&focus=40");
    EXPECT_NE(device->Told().find("exposure 8 ms, focus 40"), std::string::npos) << device->Told();
    EXPECT_EQ(value(V4L2_CID_EXPOSURE_AUTO), V4L2_EXPOSURE_MANUAL);
    EXPECT_EQ(value(V4L2_CID_EXPOSURE_ABSOLUTE), 80);
    EXPECT_EQ(value(V4L2_CID_FOCUS_AUTO), 0);
    EXPECT_EQ(value(V4L2_CID_FOCUS_ABSOLUTE), 40);
  }
  EXPECT_EQ(value(V4L2_CID_EXPOSURE_AUTO), V4L2_EXPOSURE_APERTURE_PRIORITY);
  EXPECT_EQ(value(V4L2_CID_EXPOSURE_ABSOLUTE), 157);
  EXPECT_EQ(value(V4L2_CID_FOCUS_AUTO), 1);
  EXPECT_EQ(value(V4L2_CID_FOCUS_ABSOLUTE), 30);
  {
    const auto device = Open("camera:0");
    EXPECT_NE(device->Told().find("focus held"), std::string::npos) << device->Told();
    EXPECT_EQ(value(V4L2_CID_FOCUS_AUTO), 0);
    EXPECT_EQ(value(V4L2_CID_EXPOSURE_AUTO), V4L2_EXPOSURE_APERTURE_PRIORITY);
    EXPECT_EQ(value(V4L2_CID_EXPOSURE_AUTO_PRIORITY), 0);  // the rate stays in the dark
  }
  EXPECT_THAT(MessageOf(ErrorKind::kUsage, [&] { Open("camera:0?exposure=2s"); }),
              testing::HasSubstr("0.1 ms to 500 ms"));
  EXPECT_THAT(MessageOf(ErrorKind::kUsage, [&] { Open("camera:0?focus=300"); }),
              testing::HasSubstr("focus 300 was refused"));
  camera->controls.clear();
  EXPECT_THAT(MessageOf(ErrorKind::kUsage, [&] { Open("camera:0?exposure=8ms"); }),
              testing::HasSubstr("cannot be set"));
}

TEST_F(V4l2, SaysWhyACameraCannotBeOpened) {
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { Open("camera:0"); }),
              testing::HasSubstr("there is no camera /dev/video0"));
  TheFakeBus().errors[1] = EACCES;
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { Open("camera:1"); }),
              testing::HasSubstr("group `video`"));
  Plug(0, MakeCamera());
  EXPECT_THAT(MessageOf(ErrorKind::kUsage, [&] { Open("camera:0?size=640x480"); }),
              testing::HasSubstr("no 640 x 480 images"));
  EXPECT_THAT(MessageOf(ErrorKind::kUsage, [&] { Open("camera:0?format=MJPEG"); }),
              testing::HasSubstr("no MJPEG images"));
  const auto device = Open("camera:0");
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { Open("camera:0"); }),
              testing::HasSubstr("used by another program"));
}

TEST_F(V4l2, ACameraThatComesBackUnderAnotherNumberGoesOn) {
  const auto camera = MakeCamera();
  camera->gone_after = 10;
  camera->damaged = 5;
  Plug(0, camera);
  Plug(1, MakeCamera("Camera B"));
  const auto source = OpenCameraSource("camera:0", {});
  EXPECT_TRUE(source->Info().live);
  EXPECT_EQ(source->Info().kind, "camera");
  std::thread plugger([&] {
    while (true) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      const std::lock_guard<std::mutex> lock(TheFakeBus().mutex);
      if (TheFakeBus().cameras.count(0) == 0) break;
    }
    Plug(7, MakeCamera());
  });
  double last = -1;
  int problems = 0;
  for (int i = 0; i < 30; ++i) {
    const std::optional<SourceFrame> frame = source->Next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->number, i);
    EXPECT_GT(frame->time, last);
    last = frame->time;
    problems += !frame->problem.empty();
    EXPECT_EQ(frame->image.empty(), !frame->problem.empty());
  }
  EXPECT_LE(problems, 1);
  EXPECT_GT(last, 0.3);  // seconds: it was away for a while
  plugger.join();
  const std::lock_guard<std::mutex> lock(TheFakeBus().mutex);
  EXPECT_EQ(TheFakeBus().cameras.at(7)->opened > 0, true);
  EXPECT_EQ(TheFakeBus().cameras.at(1)->streams, false);
}

TEST_F(V4l2, StopEndsTheWaitForACameraThatIsGone) {
  const auto camera = MakeCamera();
  camera->gone_after = 3;
  Plug(0, camera);
  const auto source = OpenCameraSource("camera:0", {});
  std::thread stopper([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    source->Stop();
  });
  while (source->Next()) {
  }
  stopper.join();
}

TEST_F(V4l2, TheHalvesOfAnImageAreAStereoPair) {
  Plug(0, MakeCamera());
  const TempFolder folder;
  const std::string file = folder / "pair.yaml";
  std::ofstream(file) << "model: pinhole\nfx: 40\nfy: 40\ncx: 15.5\ncy: 23.5\nwidth: 32\nheight: "
                         "48\nbaseline: 0.06\n";
  SourceOptions options;
  options.camera_file = file;
  const auto source = OpenCameraSource("camera:0?stereo=side-by-side", options);
  EXPECT_EQ(source->Info().sensor, Sensor::kStereo);
  EXPECT_EQ(source->Info().camera.width, kWidth / 2);
  const std::optional<SourceFrame> frame = source->Next();
  ASSERT_TRUE(frame);
  ASSERT_EQ(frame->right.size(), cv::Size(kWidth / 2, kHeight));
  EXPECT_EQ(frame->right.at<uchar>(9, 9) - frame->image.at<uchar>(9, 9), 100);
  EXPECT_THAT(MessageOf(ErrorKind::kUsage,
                        [&] { OpenCameraSource("camera:0", {.sensor = Sensor::kStereo}); }),
              testing::HasSubstr("stereo=side-by-side"));
  EXPECT_THAT(MessageOf(ErrorKind::kUsage,
                        [&] { OpenCameraSource("camera:0", {.sensor = Sensor::kRgbd}); }),
              testing::HasSubstr("no depth"));
}

TEST_F(V4l2, APairWithoutCalibrationIsRefused) {
  Plug(0, MakeCamera());
  EXPECT_THAT(
      MessageOf(ErrorKind::kUsage, [&] { OpenCameraSource("camera:0?stereo=side-by-side", {}); }),
      testing::HasSubstr("--camera FILE"));
}

}  // namespace
}  // namespace alidade::v4l2_test
