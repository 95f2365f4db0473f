// Settings of ORB-SLAM, stella_vslam and OpenVSLAM, EuRoC's sensor.yaml and Basalt's JSON.
#include <gtest/gtest.h>

#include "alidade/io/files/camera_file.h"
#include "support/expect_camera.h"
#include "support/expect_error.h"

namespace alidade::slam_settings_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Calibration Read(const std::string& text, const std::string& which = {}) {
  return ParseCameraFile(text, "settings.yaml", which);
}
std::string Refusal(const std::string& text, const std::string& which = {}) {
  return MessageOf(ErrorKind::kInput, [&] { Read(text, which); });
}
std::string With(std::string text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

constexpr char kOldRgbd[] = R"(%YAML:1.0

# Camera calibration and distortion parameters (OpenCV)
Camera.fx: 517.306408123
Camera.fy: 516.469215456
Camera.cx: 318.643040789
Camera.cy: 255.313989012
Camera.k1: 0.262383
Camera.k2: -0.953104
Camera.p1: -0.005358
Camera.p2: 0.002628
Camera.k3: 1.163314
Camera.width: 640
Camera.height: 480
Camera.fps: 30.0
Camera.bf: 40.0
Camera.RGB: 1
ThDepth: 40.0
DepthMapFactor: 5000.0
ORBextractor.nFeatures: 1000
)";

constexpr char kNewStereo[] = R"(%YAML:1.0

File.version: "1.0"
Camera.type: "KannalaBrandt8"
Camera1.fx: 190.97847715128717
Camera1.fy: 190.9733070521226
Camera1.cx: 254.93170605935475
Camera1.cy: 256.8974428996504
Camera1.k1: 0.0034823894022493434
Camera1.k2: 0.0007150348452162257
Camera1.k3: -0.0020532361418706202
Camera1.k4: 0.00020293673591811182
Camera2.fx: 190.44236969414825
Camera2.fy: 190.4344384721956
Camera2.cx: 252.59949716835982
Camera2.cy: 254.91723064636983
Camera2.k1: 0.0034003170790442797
Camera2.k2: 0.001766278153469831
Camera2.k3: -0.00266312569781606
Camera2.k4: 0.0003299517423931039
Stereo.T_c1_c2: !!opencv-matrix
   rows: 4
   cols: 4
   dt: f
   data: [ 1.0, 0.0, 0.0, 0.101012,
           0.0, 1.0, 0.0, 0.0019737,
           0.0, 0.0, 1.0, 0.0012345,
           0, 0, 0, 1.000000000000000 ]
Camera.width: 512
Camera.height: 512
Camera.newWidth: 384
Camera.fps: 20
)";

TEST(OrbSlamSettings, OldOnesAreRead) {
  const Calibration c = Read(kOldRgbd);
  ExpectCamera(c.left, {Lens::kPinhole,
                        640,
                        480,
                        517.306408123,
                        516.469215456,
                        318.643040789,
                        255.313989012,
                        {0.262383, -0.953104, -0.005358, 0.002628, 1.163314}});
  EXPECT_EQ(c.fps, 30);
  EXPECT_EQ(c.depth_factor, 5000);
  EXPECT_EQ(c.baseline, 0);  // bf of a depth camera is not a second camera's
  const Calibration stereo = Read(With(kOldRgbd, "DepthMapFactor: 5000.0\n", ""));
  EXPECT_NEAR(stereo.baseline, 40 / 517.306408123, 1e-12);
  EXPECT_EQ(
      Read(With(With(kOldRgbd, "Camera.width: 640\n", ""), "Camera.height: 480\n", "")).left.width,
      0);
}

TEST(OrbSlamSettings, NewOnesAreRead) {
  const Calibration c = Read(kNewStereo);
  ExpectCamera(c.left, {Lens::kFisheye,
                        512,
                        512,
                        190.97847715128717,
                        190.9733070521226,
                        254.93170605935475,
                        256.8974428996504,
                        {0.0034823894022493434, 0.0007150348452162257, -0.0020532361418706202,
                         0.00020293673591811182, 0}});
  ASSERT_TRUE(c.right);
  EXPECT_NEAR(c.right->distortion[3], 0.0003299517423931039, 1e-12);
  EXPECT_LT((c.T_left_right.t - Eigen::Vector3d(0.101012, 0.0019737, 0.0012345)).norm(), 1e-12);
  const Calibration rectified = Read(
      "File.version: \"1.0\"\nCamera.type: \"Rectified\"\nCamera1.fx: 718.856\nCamera1.fy: "
      "718.856\n"
      "Camera1.cx: 607.1928\nCamera1.cy: 185.2157\nStereo.b: 0.53716\nCamera.width: 1241\n"
      "Camera.height: 376\nCamera.fps: 10\n");
  EXPECT_EQ(rectified.baseline, 0.53716);
  EXPECT_EQ(rectified.left.lens, Lens::kPinhole);
}

// The old settings of an unrectified pair name raw cameras, rotations and projections.
TEST(OrbSlamSettings, OldPairsAreRead) {
  const auto matrix = [](const std::string& name, int rows, int cols, const std::string& data) {
    return name + ": !!opencv-matrix\n   rows: " + std::to_string(rows) +
           "\n   cols: " + std::to_string(cols) + "\n   dt: d\n   data: [" + data + "]\n";
  };
  std::string text =
      "%YAML:1.0\nCamera.fx: 435.2\nCamera.fy: 435.2\nCamera.cx: 367.4\nCamera.cy: 252.2\n"
      "Camera.width: 752\nCamera.height: 480\nCamera.bf: 47.872\n";
  for (const std::string side : {"LEFT", "RIGHT"}) {
    text += side + ".height: 480\n" + side + ".width: 752\n" +
            matrix(side + ".D", 1, 5, "-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0.0") +
            matrix(side + ".K", 3, 3,
                   side == "LEFT" ? "458.654, 0, 367.215, 0, 457.296, 248.375, 0, 0, 1"
                                  : "457.587, 0, 379.999, 0, 456.134, 255.238, 0, 0, 1") +
            matrix(side + ".R", 3, 3, "1, 0, 0, 0, 1, 0, 0, 0, 1") +
            matrix(side + ".P", 3, 4,
                   "435.2, 0, 367.4, " + std::string(side == "LEFT" ? "0" : "-47.872") +
                       ", 0, 435.2, 252.2, 0, 0, 0, 1, 0");
  }
  const Calibration c = Read(text);
  EXPECT_NEAR(c.left.fx, 458.654, 1e-9);
  EXPECT_NEAR(c.left.distortion[0], -0.28340811, 1e-12);
  ASSERT_TRUE(c.right);
  EXPECT_NEAR(c.right->cy, 255.238, 1e-9);
  EXPECT_LT((c.T_left_right.t - Eigen::Vector3d(0.11, 0, 0)).norm(), 1e-9);
}

TEST(OrbSlamSettings, MistakesAreNamed) {
  EXPECT_THAT(Refusal(With(kNewStereo, "KannalaBrandt8", "Mei")),
              AllOf(HasSubstr("settings.yaml:4: ORB-SLAM"), HasSubstr("`Mei`"),
                    HasSubstr("KannalaBrandt8")));
  EXPECT_THAT(Refusal(With(kOldRgbd, "Camera.fy: 516.469215456\n", "")),
              HasSubstr("`Camera.fy` is missing"));
  EXPECT_THAT(Refusal(With(kOldRgbd, "DepthMapFactor: 5000.0", "DepthMapFactor: 0")),
              HasSubstr("`DepthMapFactor` must be positive"));
}

constexpr char kStella[] = R"(Camera:
  name: "EuRoC monocular"
  setup: "stereo"
  model: "perspective"
  fx: 458.654123456789
  fy: 457.296123456789
  cx: 367.215123456789
  cy: 248.375123456789
  k1: -0.28340811
  k2: 0.07395907
  p1: 0.00019359
  p2: 1.76187114e-05
  k3: 0.0
  fps: 20.0
  cols: 752
  rows: 480
  color_order: "Gray"
  focal_x_baseline: 47.9
Preprocessing:
  min_size: 800
  depthmap_factor: 5000.0
)";

TEST(StellaSettings, AreRead) {
  const Calibration c = Read(kStella);
  ExpectCamera(c.left, {Lens::kPinhole,
                        752,
                        480,
                        458.654123456789,
                        457.296123456789,
                        367.215123456789,
                        248.375123456789,
                        {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0}});
  EXPECT_EQ(c.fps, 20);
  EXPECT_EQ(c.depth_factor, 5000);
  EXPECT_NEAR(c.baseline, 47.9 / 458.654123456789, 1e-12);
  EXPECT_EQ(Read(With(kStella, "\"stereo\"", "\"RGBD\"")).baseline, 0);
  // OpenVSLAM, its predecessor
  const Calibration old = Read(
      "Camera.name: \"x\"\nCamera.setup: \"monocular\"\nCamera.model: \"fisheye\"\nCamera.fx: "
      "300.5\n"
      "Camera.fy: 301.5\nCamera.cx: 320\nCamera.cy: 240\nCamera.k1: 0.01\nCamera.k2: -0.002\n"
      "Camera.k3: 0\nCamera.k4: 0.0001\nCamera.fps: 25\nCamera.cols: 640\nCamera.rows: 480\n");
  EXPECT_EQ(old.left.lens, Lens::kFisheye);
  EXPECT_NEAR(old.left.distortion[3], 0.0001, 1e-12);
  EXPECT_EQ(old.fps, 25);
}

TEST(StellaSettings, UnrectifiedPairsAreRead) {
  std::string text = kStella;
  for (const char* k :
       {"k1: -0.28340811", "k2: 0.07395907", "p1: 0.00019359", "p2: 1.76187114e-05"})
    text = With(text, k, std::string(k).substr(0, 4) + "0.0");
  text +=
      "StereoRectifier:\n  model: \"perspective\"\n"
      "  K_left: [458.654, 0.0, 367.215, 0.0, 457.296, 248.375, 0.0, 0.0, 1.0]\n"
      "  D_left: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0.0]\n"
      "  R_left: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"
      "  K_right: [457.587, 0.0, 379.999, 0.0, 456.134, 255.238, 0.0, 0.0, 1]\n"
      "  D_right: [-0.28368365, 0.07451284, -0.00010473, -3.555907e-05, 0.0]\n"
      "  R_right: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n";
  const Calibration c = Read(text);
  EXPECT_NEAR(c.left.fx, 458.654, 1e-9);
  ASSERT_TRUE(c.right);
  EXPECT_NEAR(c.right->distortion[1], 0.07451284, 1e-12);
  EXPECT_NEAR(c.T_left_right.t.x(), 47.9 / 458.654123456789, 1e-9);
}

TEST(StellaSettings, PanoramasAreRefused) {
  EXPECT_THAT(
      Refusal("Camera:\n  setup: monocular\n  model: equirectangular\n  cols: 1920\n  rows: 960\n"),
      AllOf(HasSubstr("settings.yaml:3: stella_vslam"), HasSubstr("`equirectangular`"),
            HasSubstr("perspective images")));
  EXPECT_THAT(Refusal(With(kStella, "perspective", "radial_division")),
              AllOf(HasSubstr("`model`"), HasSubstr("`radial_division`")));
}

TEST(EurocSensor, IsReadOnItsOwn) {
  const std::string text =
      "%YAML:1.0\nsensor_type: camera\ncomment: VI-Sensor cam0 (MT9M034)\nrate_hz: 20\n"
      "resolution: [752, 480]\ncamera_model: pinhole\n"
      "intrinsics: [458.654123456, 457.296123456, 367.215123456, 248.375123456]\n"
      "distortion_model: radial-tangential\n"
      "distortion_coefficients: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]\n";
  const Calibration c = Read(text);
  ExpectCamera(c.left, {Lens::kPinhole,
                        752,
                        480,
                        458.654123456,
                        457.296123456,
                        367.215123456,
                        248.375123456,
                        {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0}});
  EXPECT_EQ(c.fps, 20);
  EXPECT_THAT(Refusal(With(text, "camera_model: pinhole", "camera_model: omni")),
              AllOf(HasSubstr("EuRoC"), HasSubstr("`omni`"), HasSubstr("equidistant")));
}

std::string Basalt(const std::string& type, const std::string& values) {
  const std::string camera = R"({"camera_type": ")" + type +
                             R"(", "intrinsics": {"fx": 349.7560023050409,
 "fy": 348.72454229977037, "cx": 365.89440762590149, "cy": 249.32995565708704)" +
                             values + "}}";
  return R"({"value0": {
  "T_imu_cam": [
    {"px": -0.0168, "py": -0.0689, "pz": 0.0051, "qx": 0, "qy": 0, "qz": 0.7071067811865476, "qw": 0.7071067811865476},
    {"px": -0.0168, "py": 0.0411, "pz": 0.0051, "qx": 0, "qy": 0, "qz": 0.7071067811865476, "qw": 0.7071067811865476}],
  "intrinsics": [)" +
         camera + ",\n" + camera + R"(],
  "resolution": [[752, 480], [752, 480]],
  "calib_accel_bias": [0, 0, 0], "vignette": []}})";
}

TEST(BasaltCalibration, IsRead) {
  const Calibration c = Read(Basalt(
      "kb4", R"(, "k1": -0.0123456789, "k2": 0.00234567891, "k3": -0.0003456, "k4": 0.00001234)"));
  ExpectCamera(c.left, {Lens::kFisheye,
                        752,
                        480,
                        349.7560023050409,
                        348.72454229977037,
                        365.89440762590149,
                        249.32995565708704,
                        {-0.0123456789, 0.00234567891, -0.0003456, 0.00001234, 0}});
  ASSERT_TRUE(c.right);
  // 11 cm along the IMU's y axis, which is the cameras' x axis.
  EXPECT_LT((c.T_left_right.t - Eigen::Vector3d(0.11, 0, 0)).norm(), 1e-12);
  EXPECT_FALSE(Read(Basalt("pinhole", ""), "1").right);
  EXPECT_EQ(Read(Basalt("pinhole", "")).left.lens, Lens::kPinhole);
}

TEST(BasaltCalibration, OtherModelsAreApproximatedOrRefused) {
  for (const auto& [type, values] :
       std::map<std::string, std::string>{{"ds", R"(, "xi": -0.2409, "alpha": 0.5667)"},
                                          {"eucm", R"(, "alpha": 0.6, "beta": 1.1)"}}) {
    const Calibration c = Read(Basalt(type, values));
    EXPECT_EQ(c.left.lens, Lens::kFisheye) << type;
    EXPECT_THAT(c.told, AllOf(HasSubstr(type), HasSubstr("largest error in the image")));
  }
  EXPECT_THAT(Refusal(Basalt("mirror", "")),
              AllOf(HasSubstr("Basalt"), HasSubstr("`mirror`"), HasSubstr("kb4")));
  EXPECT_THAT(Refusal(Basalt("ds", "")), HasSubstr("must have 6 numbers, not 4"));
}

}  // namespace
}  // namespace alidade::slam_settings_test
