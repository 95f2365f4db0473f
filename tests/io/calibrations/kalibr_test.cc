#include <gtest/gtest.h>

#include "alidade/io/files/camera_file.h"
#include "support/expect_camera.h"
#include "support/expect_error.h"

namespace alidade::kalibr_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr char kPair[] = R"(cam0:
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [-0.29545645106987750, 0.08257575639663768, 0.00019411112305462, 1.76187114e-05]
  distortion_model: radtan
  intrinsics: [461.62913470197345, 460.29992345678917, 362.68095678912343, 246.04900123456789]
  resolution: [752, 480]
  rostopic: /cam0/image_raw
cam1:
  T_cn_cnm1:
  - [0.9999992248836708, 6.223483053845e-05, 0.0012434926471, -0.11022942516781]
  - [-6.622245e-05, 0.9999948729, 0.0032015446, 0.00039902]
  - [-0.0012432866, -0.0032016246, 0.999994102, -0.00085310]
  - [0.0, 0.0, 0.0, 1.0]
  cam_overlaps: [0]
  camera_model: pinhole
  distortion_coeffs: [-0.29481678, 0.08199271, -0.00020434, 1.0e-05]
  distortion_model: radtan
  intrinsics: [460.16785432198765, 458.94102345678912, 373.44423456789123, 254.93101234567891]
  resolution: [752, 480]
  rostopic: /cam1/image_raw
)";

std::string One(const std::string& lines) {
  return "cam0:\n  resolution: [640, 480]\n  rostopic: /cam0/image_raw\n" + lines;
}

std::string Refusal(const std::string& text, const std::string& which = {}) {
  return MessageOf(ErrorKind::kInput, [&] { ParseCameraFile(text, "chain.yaml", which); });
}

TEST(Kalibr, PairsAreRead) {
  const Calibration c = ParseCameraFile(kPair, "chain.yaml");
  ExpectCamera(c.left, {Lens::kPinhole,
                        752,
                        480,
                        461.62913470197345,
                        460.29992345678917,
                        362.68095678912343,
                        246.04900123456789,
                        {-0.29545645106987750, 0.08257575639663768, 0.00019411112305462,
                         1.76187114e-05, 0}});
  ASSERT_TRUE(c.right);
  EXPECT_NEAR(c.right->cy, 254.93101234567891, 1e-9);
  // T_cn_cnm1 maps the points of camera 0 into camera 1; ours is the other way round.
  const Eigen::Vector3d p_left(0.3, -0.2, 2);
  const Eigen::Vector3d p_right(
      0.9999992248836708 * 0.3 + 6.223483053845e-05 * -0.2 + 0.0012434926471 * 2 - 0.11022942516781,
      -6.622245e-05 * 0.3 + 0.9999948729 * -0.2 + 0.0032015446 * 2 + 0.00039902,
      -0.0012432866 * 0.3 - 0.0032016246 * -0.2 + 0.999994102 * 2 - 0.00085310);
  // The rotation in the file has ten digits; it is made orthonormal.
  EXPECT_LT((c.T_left_right * p_right - p_left).norm(), 1e-6);
  EXPECT_GT(c.T_left_right.t.x(), 0.1);
  EXPECT_EQ(c.origin, "chain.yaml");
  EXPECT_EQ(c.told, "");
}

TEST(Kalibr, APairMayBeToldByTheImu) {
  std::string text =
      One("  camera_model: pinhole\n  distortion_coeffs: [0.01, -0.002, 0.003, -0.0004]\n"
          "  distortion_model: equi\n  intrinsics: [190.97847715128717, 190.9733070521226, "
          "254.93170605935475, 256.8974428996504]\n"
          "  T_cam_imu: [[0, 1, 0, 0.05], [-1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n");
  std::string second = text.substr(text.find('\n'));
  second.replace(second.find("0.05"), 4, "-0.07");
  const Calibration c = ParseCameraFile(text + "cam1:" + second, "chain.yaml");
  EXPECT_EQ(c.left.lens, Lens::kFisheye);
  EXPECT_NEAR(c.left.distortion[3], -0.0004, 1e-12);
  ASSERT_TRUE(c.right);
  // Both are turned alike; the IMU is 5 cm right of one and 7 cm left of the other.
  EXPECT_LT((c.T_left_right.t - Eigen::Vector3d(0.12, 0, 0)).norm(), 1e-9);
  EXPECT_LT(RotationAngle(c.T_left_right, Se3()), 1e-9);
}

TEST(Kalibr, OneCameraOfAChainMayBeChosen) {
  const Calibration c = ParseCameraFile(kPair, "chain.yaml", "cam1");
  EXPECT_NEAR(c.left.fx, 460.16785432198765, 1e-9);
  EXPECT_FALSE(c.right);
  EXPECT_THAT(Refusal(kPair, "cam2"), HasSubstr("`cam2` is missing"));
}

TEST(Kalibr, NoDistortionIsNone) {
  const Calibration c = ParseCameraFile(
      One("  camera_model: pinhole\n  distortion_model: none\n  distortion_coeffs: []\n"
          "  intrinsics: [300, 301, 320, 240]\n"),
      "x");
  EXPECT_EQ(c.left.distortion, (std::array<double, 5>{}));
}

// Double sphere, Usenko et al. 2018, equations 40 to 42: what the approximation says is right.
TEST(Kalibr, ADoubleSphereIsApproximated) {
  const double fx = 160.5, fy = 159.5, cx = 320.25, cy = 240.75, xi = -0.2, alpha = 0.58;
  const Calibration c =
      ParseCameraFile(One("  camera_model: ds\n  distortion_model: none\n  distortion_coeffs: []\n"
                          "  intrinsics: [-0.2, 0.58, 160.5, 159.5, 320.25, 240.75]\n"),
                      "x");
  EXPECT_EQ(c.left.lens, Lens::kFisheye);
  EXPECT_THAT(c.told, AllOf(HasSubstr("ds"), HasSubstr("pixels")));
  double farthest = 0;
  for (double angle = 0.02; angle < 1.5; angle += 0.02) {
    for (double turn = 0; turn < 6.3; turn += 0.1) {
      const Eigen::Vector3d p(std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn),
                              std::cos(angle));
      const double d1 = p.norm(), z = xi * d1 + p.z(), d2 = std::hypot(p.x(), p.y(), z);
      const double below = alpha * d2 + (1 - alpha) * z;
      const Eigen::Vector2d pixel(fx * p.x() / below + cx, fy * p.y() / below + cy);
      if (pixel.x() < 0 || pixel.y() < 0 || pixel.x() > 639 || pixel.y() > 479) continue;
      farthest = std::max(farthest, (c.left.Project(p) - pixel).norm());
    }
  }
  EXPECT_GT(farthest, 0);
  EXPECT_LT(farthest, 0.5);
}

TEST(Kalibr, OtherModelsAreRefusedByName) {
  EXPECT_THAT(
      Refusal(One("  camera_model: omni\n  distortion_model: radtan\n"
                  "  distortion_coeffs: [-0.2, 0.1, 0.001, 0]\n"
                  "  intrinsics: [1.5, 800, 801, 320, 240]\n")),
      AllOf(HasSubstr("chain.yaml:4: Kalibr"), HasSubstr("`omni`"), HasSubstr("pinhole-equi")));
  EXPECT_THAT(Refusal(One("  camera_model: cylinder\n  intrinsics: [800, 801, 320, 240]\n")),
              AllOf(HasSubstr("Kalibr"), HasSubstr("`cylinder`"), HasSubstr("calibrate again")));
  EXPECT_THAT(Refusal(One("  camera_model: pinhole\n  distortion_model: bent\n"
                          "  distortion_coeffs: [1]\n  intrinsics: [800, 801, 320, 240]\n")),
              AllOf(HasSubstr("distortion_model `bent`"), HasSubstr("pinhole-radtan")));
}

// A second camera that cannot be used does not hinder the first.
TEST(Kalibr, AStrangeSecondCameraIsLeftOut) {
  std::string text = kPair;
  const size_t at = text.rfind("pinhole");
  text.replace(at, 7, "cylinder");
  WarningCatcher warnings;
  const Calibration c = ParseCameraFile(text, "chain.yaml");
  EXPECT_FALSE(c.right);
  EXPECT_THAT(warnings.text(), AllOf(HasSubstr("`cylinder`"), HasSubstr("only cam0 is used")));
}

TEST(Kalibr, ADamagedPoseOfTheSecondCameraDoesNotHinderTheFirst) {
  std::string text = kPair;
  text.replace(text.find("0.9999992248836708"), 18, "7.0");
  WarningCatcher warnings;
  const Calibration c = ParseCameraFile(text, "chain.yaml");
  EXPECT_FALSE(c.right);
  EXPECT_EQ(c.told, "");
  EXPECT_THAT(warnings.text(), AllOf(HasSubstr("`T_cn_cnm1`"), HasSubstr("only cam0 is used")));
}

}  // namespace
}  // namespace alidade::kalibr_test
