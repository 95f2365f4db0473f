#include <gtest/gtest.h>

#include "alidade/io/files/camera_file.h"
#include "support/expect_camera.h"
#include "support/expect_error.h"

namespace alidade::ros_calibration_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// As written by camera_calibration and read by camera_info_manager.
constexpr char kFile[] = R"(image_width: 640
image_height: 480
camera_name: narrow_stereo
camera_matrix:
  rows: 3
  cols: 3
  data: [517.30640812345, 0.00000, 318.64304123456, 0.00000, 516.46921512345, 255.31398912345, 0.00000, 0.00000, 1.00000]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [0.26238312, -0.95310412, -0.00535812, 0.00262812, 1.16331412]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1.00000, 0.00000, 0.00000, 0.00000, 1.00000, 0.00000, 0.00000, 0.00000, 1.00000]
projection_matrix:
  rows: 3
  cols: 4
  data: [520.5, 0.00000, 318.6, 0.00000, 0.00000, 519.5, 255.3, 0.00000, 0.00000, 0.00000, 1.00000, 0.00000]
)";

constexpr char kEcho[] = R"(header:
  stamp:
    sec: 1617183812
    nanosec: 300000000
  frame_id: camera_color_optical_frame
height: 1080
width: 1920
distortion_model: plumb_bob
d:
- 0.0
- 0.0
- 0.0
- 0.0
- 0.0
k:
- 1383.123456789
- 0.0
- 958.7654321098
- 0.0
- 1382.98765432109
- 541.1234567891
- 0.0
- 0.0
- 1.0
r: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
p: [1383.123456789, 0.0, 958.7654321098, -165.9748148147, 0.0, 1382.98765432109, 541.1234567891, 0.0, 0.0, 0.0, 1.0, 0.0]
binning_x: 2
binning_y: 2
roi:
  x_offset: 200
  y_offset: 100
  height: 800
  width: 1600
  do_rectify: false
---
)";

std::string With(std::string text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

Calibration Read(const std::string& text) { return ParseCameraFile(text, "info.yaml"); }
std::string Refusal(const std::string& text) {
  return MessageOf(ErrorKind::kInput, [&] { Read(text); });
}

TEST(RosCalibration, FilesAreRead) {
  const Calibration c = Read(kFile);
  ExpectCamera(c.left, {Lens::kPinhole,
                        640,
                        480,
                        517.30640812345,
                        516.46921512345,
                        318.64304123456,
                        255.31398912345,
                        {0.26238312, -0.95310412, -0.00535812, 0.00262812, 1.16331412}});
  EXPECT_EQ(c.baseline, 0);
  EXPECT_EQ(c.told, "");
}

TEST(RosCalibration, PrintedMessagesAreReadWithBinningAndRegion) {
  const RawCamera wanted = {Lens::kPinhole,
                            800,
                            400,
                            1383.123456789 / 2,
                            1382.98765432109 / 2,
                            (958.7654321098 - 200 + 0.5) / 2 - 0.5,
                            (541.1234567891 - 100 + 0.5) / 2 - 0.5,
                            {}};
  ExpectCamera(Read(kEcho).left, wanted);
  EXPECT_NEAR(Read(kEcho).baseline, 165.9748148147 / 1383.123456789, 1e-9);
  // `ros2 topic echo` prints one message after the other, `rostopic echo` capital names.
  ExpectCamera(Read(kEcho + std::string(kEcho)).left, wanted);
  std::string ros1 = kEcho;
  for (const char* name : {"d", "k", "r", "p"})
    ros1 = With(ros1, std::string("\n") + name + ":",
                std::string("\n") + static_cast<char>(name[0] - 32) + ":");
  ExpectCamera(Read(ros1).left, wanted);
}

TEST(RosCalibration, TheNumberOfCoefficientsBeatsTheModelsName) {
  const Calibration c = Read(With(With(kFile, "cols: 5", "cols: 8"),
                                  "[0.26238312, -0.95310412, -0.00535812, 0.00262812, 1.16331412]",
                                  "[0.1, -0.05, 0.0008, -0.0003, 0.01, 0.05, 0.01, 0.0]"));
  EXPECT_EQ(c.left.lens, Lens::kPinhole);
  EXPECT_THAT(c.told, AllOf(HasSubstr("rational"), HasSubstr("pixels")));
  // At (0.5, 0.3): (1 + 0.1 r² - 0.05 r⁴ + 0.01 r⁶) / (1 + 0.05 r² + 0.01 r⁴), and tangential
  // terms.
  const double x = 0.5, y = 0.3, r2 = x * x + y * y;
  const double radial = (1 + r2 * (0.1 + r2 * (-0.05 + r2 * 0.01))) / (1 + r2 * (0.05 + r2 * 0.01));
  const double u = x * radial + 2 * 0.0008 * x * y - 0.0003 * (r2 + 2 * x * x);
  const double v = y * radial + 0.0008 * (r2 + 2 * y * y) - 2 * 0.0003 * x * y;
  const Eigen::Vector2d wanted(c.left.fx * u + c.left.cx, c.left.fy * v + c.left.cy);
  EXPECT_LT((c.left.Project({x, y, 1}) - wanted).norm(), 0.5);
}

TEST(RosCalibration, FisheyesAreRead) {
  const Calibration c = Read(With(With(kFile, "plumb_bob", "equidistant"),
                                  "[0.26238312, -0.95310412, -0.00535812, 0.00262812, 1.16331412]",
                                  "[0.0123456789, -0.003, 0.001, -0.0002]"));
  EXPECT_EQ(c.left.lens, Lens::kFisheye);
  EXPECT_NEAR(c.left.distortion[0], 0.0123456789, 1e-12);
  EXPECT_NEAR(c.left.distortion[3], -0.0002, 1e-12);
}

// One camera can be used all the same.
TEST(RosCalibration, ABaselineThatCannotBeUsedIsTold) {
  const Calibration negative = Read(With(kEcho, "-165.97", "165.97"));
  EXPECT_EQ(negative.baseline, 0);
  EXPECT_THAT(negative.told, HasSubstr("the file of the right camera"));
  const Calibration raw = Read(With(kFile, "318.6, 0.00000,", "318.6, -52.05,"));
  EXPECT_EQ(raw.baseline, 0);
  EXPECT_THAT(raw.told, HasSubstr("not rectified"));
}

TEST(RosCalibration, PaddedCoefficientsAreRead) {
  const Calibration c = Read(With(With(kFile, "cols: 5", "cols: 10"),
                                  "[0.26238312, -0.95310412, -0.00535812, 0.00262812, 1.16331412]",
                                  "[0.1, -0.05, 0.0008, -0.0003, 0.01, 0.05, 0.01, 0.001, 0, 0]"));
  EXPECT_THAT(c.told, HasSubstr("rational"));
}

TEST(RosCalibration, WhatIsWrongIsNamed) {
  EXPECT_THAT(Refusal(With(kFile, "plumb_bob", "thin_prism_6")),
              AllOf(HasSubstr("info.yaml:"), HasSubstr("ROS camera_info"),
                    HasSubstr("`thin_prism_6`"), HasSubstr("supported are")));
  EXPECT_THAT(Refusal(With(kFile, "517.30640812345", "0")), HasSubstr("`camera_matrix`"));
  EXPECT_THAT(Refusal(With(kFile, "640", "0")), HasSubstr("`image_width`"));
  EXPECT_THAT(Refusal(With(kFile, ", 1.00000]\ndistortion_model", "]\ndistortion_model")),
              HasSubstr("`camera_matrix` must have 9 numbers, not 8"));
  EXPECT_THAT(Refusal(With(kEcho, "binning_x: 2", "binning_x: 2.5")), HasSubstr("`binning_x`"));
}

}  // namespace
}  // namespace alidade::ros_calibration_test
