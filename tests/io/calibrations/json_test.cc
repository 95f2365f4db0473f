// COLMAP's cameras.txt, and the JSON of nerfstudio, RealSense and OAK.
#include <gtest/gtest.h>

#include "alidade/io/files/camera_file.h"
#include "support/expect_camera.h"
#include "support/expect_error.h"

namespace alidade::json_calibration_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Calibration Read(const std::string& text, const std::string& which = {}) {
  return ParseCameraFile(text, "cal", which);
}
std::string Refusal(const std::string& text, const std::string& which = {}) {
  return MessageOf(ErrorKind::kInput, [&] { Read(text, which); });
}

TEST(ColmapCameras, AllModelsThatCanBeExpressedAreRead) {
  const auto one = [](const std::string& line) {
    return Read(
        "# Camera list with one line of data per camera:\n#   CAMERA_ID, MODEL, WIDTH, "
        "HEIGHT, PARAMS[]\n# Number of cameras: 1\n1 " +
        line + "\n");
  };
  const double cx = 1600.25 - 0.5, cy = 1201.75 - 0.5;
  const auto wanted = [&](double fx, double fy, Lens lens, const std::array<double, 5>& k) {
    return RawCamera{lens, 3200, 2400, fx, fy, cx, cy, k};
  };
  const std::string two = " 3200 2400 2559.6812345678 2558.1234567891 1600.25 1201.75";
  const std::string single = " 3200 2400 2559.6812345678 1600.25 1201.75";
  const double f = 2559.6812345678, fy = 2558.1234567891;
  ExpectCamera(one("SIMPLE_PINHOLE" + single).left, wanted(f, f, Lens::kPinhole, {}));
  ExpectCamera(one("PINHOLE" + two).left, wanted(f, fy, Lens::kPinhole, {}));
  ExpectCamera(one("SIMPLE_RADIAL" + single + " -0.0204997").left,
               wanted(f, f, Lens::kPinhole, {-0.0204997}));
  ExpectCamera(one("RADIAL" + single + " -0.02 0.003").left,
               wanted(f, f, Lens::kPinhole, {-0.02, 0.003}));
  ExpectCamera(one("OPENCV" + two + " -0.02 0.003 0.0004 -0.0005").left,
               wanted(f, fy, Lens::kPinhole, {-0.02, 0.003, 0.0004, -0.0005}));
  ExpectCamera(one("FULL_OPENCV" + two + " -0.02 0.003 0.0004 -0.0005 0.006 0 0 0").left,
               wanted(f, fy, Lens::kPinhole, {-0.02, 0.003, 0.0004, -0.0005, 0.006}));
  ExpectCamera(one("OPENCV_FISHEYE" + two + " -0.02 0.003 0.0004 -0.0005").left,
               wanted(f, fy, Lens::kFisheye, {-0.02, 0.003, 0.0004, -0.0005}));
  ExpectCamera(one("RADIAL_FISHEYE" + single + " -0.02 0.003").left,
               wanted(f, f, Lens::kFisheye, {-0.02, 0.003}));
  const Calibration rational = one("FULL_OPENCV" + two + " -0.02 0.003 0 0 0 0.01 0 0");
  EXPECT_THAT(rational.told, HasSubstr("pixels"));
}

TEST(ColmapCameras, MistakesAreNamed) {
  EXPECT_THAT(Refusal("1 THIN_PRISM_FISHEYE 640 480 1 1 1 1 1 1 1 1 1 1 1 1\n"),
              AllOf(HasSubstr("cal:1: COLMAP"), HasSubstr("`THIN_PRISM_FISHEYE`"),
                    HasSubstr("image_undistorter")));
  EXPECT_THAT(Refusal("1 PINHOLE 640 480 500 500 320\n"), HasSubstr("4 parameters, not 3"));
  EXPECT_THAT(Refusal("1 PINHOLE 640 480 500 x 320 240\n"), HasSubstr("`x` is not a number"));
  EXPECT_THAT(Refusal("1 PINHOLE 640 480 nan 500 320 240\n"), HasSubstr("`nan`"));
  EXPECT_THAT(Refusal("1 PINHOLE 640 -480 500 500 320 240\n"), HasSubstr("`-480`"));
  const std::string three =
      "1 PINHOLE 640 480 500 500 320 240\n2 PINHOLE 64 48 50 50 32 24\n7 PINHOLE 32 24 25 25 16 "
      "12\n";
  EXPECT_THAT(Refusal(three),
              AllOf(HasSubstr("3 cameras"), HasSubstr("1, 2, 7"), HasSubstr("--camera cal#1")));
  EXPECT_EQ(Read(three, "2").left.width, 64);
  EXPECT_THAT(Refusal(three, "3"), HasSubstr("no CAMERA_ID `3`"));
}

TEST(NerfstudioTransforms, AreRead) {
  const std::string head = R"({
	"camera_model": "OPENCV",
	"fl_x": 1072.2512345678, "fl_y": 1071.1212345678,
	"cx": 960.5123456789, "cy": 540.4123456789, "w": 1920, "h": 1080,
	"k1": 0.0312345678, "k2": -0.0212345678, "p1": 0.000812345, "p2": -0.000312345,
	"aabb_scale": 16)";
  const RawCamera wanted = {Lens::kPinhole,
                            1920,
                            1080,
                            1072.2512345678,
                            1071.1212345678,
                            960.0123456789,
                            539.9123456789,
                            {0.0312345678, -0.0212345678, 0.000812345, -0.000312345, 0}};
  ExpectCamera(Read(head + "}").left, wanted);
  // With its images, more values than a camera file may have.
  std::string frames = head + ",\n\"frames\": [\n";
  for (int i = 0; i < 1000; ++i) {
    frames +=
        std::string(i > 0 ? "," : "") + R"({"file_path": "images/frame_)" + std::to_string(i) +
        R"(.jpg", "transform_matrix": [[1, 0, 0, 0.5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]})" +
        "\n";
  }
  ExpectCamera(Read(frames + "]}").left, wanted);
  const size_t middle = frames.size() / 2;
  Refusal(frames.substr(0, middle));  // damaged, after however long a list
  std::string fisheye = head + "}";
  fisheye.replace(fisheye.find("OPENCV"), 6, "OPENCV_FISHEYE");
  EXPECT_EQ(Read(fisheye).left.lens, Lens::kFisheye);
}

TEST(NerfstudioTransforms, IntrinsicsMayBeThoseOfTheImages) {
  const auto frame = [](const std::string& fx) {
    return R"({"file_path": "a.png", "fl_x": )" + fx +
           R"(, "fl_y": 500, "cx": 320, "cy": 240, "w": 640, "h": 480})";
  };
  EXPECT_EQ(Read("{\"frames\": [" + frame("501") + "," + frame("501") + "]}").left.fx, 501);
  EXPECT_THAT(Refusal("{\"frames\": [" + frame("501") + "," + frame("502") + "]}"),
              AllOf(HasSubstr("nerfstudio"), HasSubstr("`fl_x`"), HasSubstr("one camera")));
}

TEST(NerfstudioTransforms, AFieldOfViewIsACamera) {
  const Calibration c =
      Read(R"({"camera_angle_x": 0.6911112070083618, "w": 800, "h": 600, "frames": []})");
  EXPECT_NEAR(c.left.fx, 400 / std::tan(0.6911112070083618 / 2), 1e-9);
  EXPECT_EQ(c.left.cx, 399.5);
  EXPECT_THAT(Refusal(R"({"camera_angle_x": 0.69, "frames": []})"),
              AllOf(HasSubstr("`camera_angle_x`"), HasSubstr("--fov")));
  EXPECT_THAT(Refusal(R"({"camera_model": "EQUIRECTANGULAR", "fl_x": 1, "w": 800, "h": 600})"),
              AllOf(HasSubstr("nerfstudio"), HasSubstr("`EQUIRECTANGULAR`")));
}

std::string RealSense(const std::string& model, const std::string& coeffs) {
  return R"({"width": 640, "height": 480, "ppx": 318.4123456789, "ppy": 241.5123456789, "fx": 381.9123456789,
 "fy": 381.6123456789, "model": ")" +
         model + R"(", "coeffs": )" + coeffs + "}";
}

TEST(RealSenseIntrinsics, AreRead) {
  for (const char* model :
       {"distortion.brown_conrady", "RS2_DISTORTION_BROWN_CONRADY", "Brown Conrady"}) {
    ExpectCamera(
        Read(RealSense(model, "[-0.05512345, 0.06512345, -0.0007, 0.0008, -0.0212345]")).left,
        {Lens::kPinhole,
         640,
         480,
         381.9123456789,
         381.6123456789,
         318.4123456789,
         241.5123456789,
         {-0.05512345, 0.06512345, -0.0007, 0.0008, -0.0212345}});
  }
  EXPECT_EQ(
      Read(RealSense("distortion.kannala_brandt4", "[-0.01, 0.04, -0.03, 0.005, 0]")).left.lens,
      Lens::kFisheye);
  // All models without coefficients are no distortion.
  EXPECT_EQ(Read(RealSense("ftheta", "[0, 0, 0, 0, 0]")).told, "");
  // As Python prints a dict.
  EXPECT_EQ(Read("{'width': 640, 'height': 480, 'ppx': 1, 'ppy': 2, 'fx': 3, 'fy': 4}").left.fx, 3);
}

// The inverse model maps distorted to ideal positions.
TEST(RealSenseIntrinsics, TheInverseModelIsApproximated) {
  const Calibration c = Read(
      RealSense("distortion.inverse_brown_conrady", "[-0.0555, 0.0655, -0.0007, 0.0008, -0.021]"));
  EXPECT_THAT(c.told, AllOf(HasSubstr("inverse Brown-Conrady"), HasSubstr("pixels")));
  double farthest = 0;
  for (int v = 0; v < 480; v += 37) {
    for (int u = 0; u < 640; u += 37) {
      const double x = (u - 318.4123456789) / 381.9123456789,
                   y = (v - 241.5123456789) / 381.6123456789;
      const double r2 = x * x + y * y, radial = 1 + r2 * (-0.0555 + r2 * (0.0655 + r2 * -0.021));
      const Eigen::Vector3d p(x * radial + 2 * -0.0007 * x * y + 0.0008 * (r2 + 2 * x * x),
                              y * radial + 2 * 0.0008 * x * y - 0.0007 * (r2 + 2 * y * y), 1);
      farthest = std::max(farthest, (c.left.Project(p) - Eigen::Vector2d(u, v)).norm());
    }
  }
  EXPECT_GT(farthest, 0);
  EXPECT_LT(farthest, 0.5);
}

TEST(RealSenseIntrinsics, AStreamIsChosen) {
  const std::string two = "{\"color\": " + RealSense("none", "[]") +
                          ", \"depth\": " + RealSense("none", "[]") + ", \"depth_scale\": 0.001}";
  EXPECT_NEAR(*Read(two, "color").depth_factor, 1000, 1e-9);
  EXPECT_THAT(Refusal(two), AllOf(HasSubstr("color, depth"), HasSubstr("--camera cal#color")));
  EXPECT_THAT(Refusal(two, "infra"), HasSubstr("no stream `infra`"));
  EXPECT_EQ(Read("{\"color\": " + RealSense("none", "[]") + "}").left.width, 640);
  EXPECT_THAT(Refusal(RealSense("ftheta", "[0.9, 0, 0, 0, 0]")),
              AllOf(HasSubstr("RealSense"), HasSubstr("`ftheta`"), HasSubstr("record another")));
}

std::string Oak(int type, const std::string& k, const std::string& cameras = {}) {
  const auto camera = [&](const std::string& x, int to) {
    return R"({"cameraType": )" + std::to_string(type) + R"(, "distortionCoeff": )" + k +
           R"(, "extrinsics": {"rotationMatrix": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
 "specTranslation": {"x": 0.0, "y": 0.0, "z": 0.0}, "toCameraSocket": )" +
           std::to_string(to) + R"(, "translation": {"x": )" + x +
           R"(, "y": 0.0123456789, "z": 0.0}},
 "height": 800, "intrinsicMatrix": [[801.1234567891, 0.0, 639.2345678912], [0.0, 802.2345678912, 398.3456789123], [0.0, 0.0, 1.0]],
 "lensPosition": 0, "specHfovDeg": 71.86, "width": 1280})";
  };
  return "{\"batchName\": \"\", \"boardName\": \"OAK-D\", \"cameraData\": [[1, " +
         camera("-7.5123456789", 2) + "], [2, " + camera("0.0", -1) + "]" + cameras +
         "], \"version\": 6}";
}

TEST(OakCalibration, IsRead) {
  const Calibration c =
      Read(Oak(0, "[-0.04, 0.06, 0.0007, -0.0008, -0.02, 0, 0, 0, 0, 0, 0, 0, 0, 0]"), "1");
  const RawCamera wanted = {Lens::kPinhole,
                            1280,
                            800,
                            801.1234567891,
                            802.2345678912,
                            639.2345678912,
                            398.3456789123,
                            {-0.04, 0.06, 0.0007, -0.0008, -0.02}};
  ExpectCamera(c.left, wanted);
  ASSERT_TRUE(c.right);  // centimeters
  EXPECT_LT((c.T_left_right.t - Eigen::Vector3d(0.075123456789, -0.000123456789, 0)).norm(), 1e-12);
  EXPECT_FALSE(Read(Oak(0, "[]"), "2").right);
  EXPECT_EQ(Read(Oak(1, "[0.01, 0, 0, 0]"), "1").left.lens, Lens::kFisheye);
}

TEST(OakCalibration, ACameraMustBeChosen) {
  EXPECT_THAT(Refusal(Oak(0, "[]")),
              AllOf(HasSubstr("OAK"), HasSubstr("1, 2"), HasSubstr("--camera cal#1")));
  EXPECT_THAT(Refusal(Oak(3, "[]"), "1"), AllOf(HasSubstr("`cameraType`"), HasSubstr("`3`")));
  EXPECT_THAT(Refusal(Oak(0, "[]"), "9"), HasSubstr("no camera socket `9`"));
}

}  // namespace
}  // namespace alidade::json_calibration_test
