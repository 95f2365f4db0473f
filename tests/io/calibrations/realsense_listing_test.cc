// What `rs-enumerate-devices -c` prints.
#include <gtest/gtest.h>

#include "alidade/io/files/camera_file.h"
#include "support/expect_camera.h"
#include "support/expect_error.h"

namespace alidade::realsense_listing_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string Entry(const std::string& title, int width, int height, double fx,
                  const std::string& lens = "Inverse Brown Conrady") {
  return " Intrinsic of " + title + "\n  Width:      \t" + std::to_string(width) +
         "\n  Height:     \t" + std::to_string(height) + "\n  PPX:        \t" +
         std::to_string(width / 2 + 0.25) + "\n  PPY:        \t" +
         std::to_string(height / 2 - 0.5) + "\n  Fx:         \t" + std::to_string(fx) +
         "\n  Fy:         \t" + std::to_string(fx + 1) + "\n  Distortion: \t" + lens +
         "\n  Coeffs:     \t0  \t0  \t0  \t0  \t0  \n  FOV (deg):  \t55.51 x 43.07\n\n";
}

const std::string kListing =
    "Device info: \n    Name                          : \tIntel RealSense D435I\n    Serial Number "
    "                : \t123456789\n\nStream Profiles supported by RGB Camera\n\nIntrinsic "
    "Parameters:\n\n" +
    Entry("\"Depth\" / 640x480 / {Z16}", 640, 480, 380, "Brown Conrady") +
    Entry("\"Infrared 1\" / 1280x800 / {Y8}", 1280, 800, 640, "Brown Conrady") +
    Entry("\"Infrared 1\" / 1280x800 / {Y16}", 1280, 800, 650, "Brown Conrady") +
    Entry("\"Color\" / 640x480 / {YUYV/RGB8/BGR8}", 640, 480, 607.5) +
    Entry("\"Color\"\t  1280x720\t  {YUYV/RGB8/BGR8}", 1280, 720, 911) +
    "Motion Intrinsic Parameters:\n\n Motion Intrinsic of \"Gyro\"\t  {MOTION_XYZ32F}\n Bias "
    "Variances:  \t0  0  0  \n\n Extrinsic Parameters:\n\n Extrinsic from \"Depth\"\t  To\t  "
    "\"Color\" :\n Rotation Matrix:\n   1 0 0\n";

Calibration Read(const std::string& which, cv::Size images = {}) {
  return ParseCameraFile(kListing, "rs.txt", which, images);
}

TEST(RealSenseListing, StreamAndSizeAreChosen) {
  const RawCamera vga = {Lens::kPinhole, 640, 480, 607.5, 608.5, 320.25, 239.5, {}};
  const RawCamera hd = {Lens::kPinhole, 1280, 720, 911, 912, 640.25, 359.5, {}};
  ExpectCamera(Read("Color/640x480").left, vga);
  ExpectCamera(Read("Color/1280x720").left, hd);
  ExpectCamera(Read("Color", {640, 480}).left, vga);
  ExpectCamera(Read("Color", {1280, 720}).left, hd);
  EXPECT_EQ(Read("Depth").left.fx, 380);
  EXPECT_EQ(Read("Infrared 1").left.fx, 640);  // not that of the unrectified Y16
}

TEST(RealSenseListing, WhatToChooseIsSaid) {
  const auto refusal = [](const std::string& which, cv::Size images = {}) {
    return MessageOf(ErrorKind::kInput, [&] { Read(which, images); });
  };
  EXPECT_THAT(refusal(""), AllOf(HasSubstr("Depth, Infrared 1, Color"), HasSubstr("rs.txt#Color")));
  EXPECT_THAT(refusal("RGB"), HasSubstr("no stream `RGB`"));
  EXPECT_THAT(refusal("Color"),
              AllOf(HasSubstr("640x480, 1280x720"), HasSubstr("rs.txt#Color/640x480")));
  EXPECT_THAT(refusal("Color", {848, 480}), HasSubstr("none for images of 848x480"));
}

TEST(RealSenseListing, MistakesHaveALine) {
  std::string text = Entry("\"Color\" / 640x480 / {RGB8}", 640, 480, 607.5);
  text.replace(text.find("607.5"), 3, "abc");
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { ParseCameraFile(text, "rs.txt"); }),
              HasSubstr("rs.txt:6: "));
  const std::string twice = kListing + kListing;
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { ParseCameraFile(twice, "rs.txt", "Color"); }),
              HasSubstr("several RealSense devices"));
}

}  // namespace
}  // namespace alidade::realsense_listing_test
