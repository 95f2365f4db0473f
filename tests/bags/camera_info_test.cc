// CameraInfo converted to cameras, compared with OpenCV's projection.
#include "alidade/io/ros/camera_info.h"

#include <gmock/gmock.h>

#include <opencv2/calib3d.hpp>

#include "alidade/io/ros/messages/messages.h"
#include "bags/message_bytes.h"
#include "support/expect_error.h"

namespace alidade::camera_info_test {
namespace {

using testing::HasSubstr;

RosCameraInfo Read(const InfoFields& fields, Dialect dialect = {true}) {
  return ParseRosCameraInfo(InfoMessage(dialect, 5, fields),
                            dialect.cdr ? Serialization::kCdr : Serialization::kRos1);
}

RawCamera CameraOf(const InfoFields& fields, bool rectified = false) {
  const auto camera = CameraOfInfo(Read(fields), rectified);
  EXPECT_TRUE(camera);
  return camera.value_or(RawCamera{});
}

InfoFields Wide() {
  InfoFields info;
  info.width = 1280;
  info.height = 720;
  info.K = {700, 0, 640, 0, 701, 360, 0, 0, 1};
  return info;
}

// Largest distance in pixels between Alidade's and OpenCV's projections over the image.
double FarthestFromOpenCv(const InfoFields& info, const RawCamera& camera) {
  double farthest = 0;
  const cv::Mat K(3, 3, CV_64F, const_cast<double*>(info.K.data()));
  for (double x = -0.85; x <= 0.85; x += 0.05) {
    for (double y = -0.48; y <= 0.48; y += 0.05) {
      std::vector<cv::Point2d> pixels;
      cv::projectPoints(std::vector<cv::Point3d>{{x, y, 1}}, cv::Vec3d(), cv::Vec3d(), K, info.D,
                        pixels);
      const Eigen::Vector2d ours = camera.Project({x, y, 1});
      if (pixels[0].x < 0 || pixels[0].y < 0 || pixels[0].x > info.width ||
          pixels[0].y > info.height)
        continue;
      farthest = std::max(farthest, (ours - Eigen::Vector2d(pixels[0].x, pixels[0].y)).norm());
    }
  }
  return farthest;
}

TEST(CameraInfo, IsReadInBothDialects) {
  for (const Dialect dialect : {Dialect{false}, Dialect{true}, Dialect{true, true}}) {
    InfoFields fields = Wide();
    fields.model = "plumb_bob";
    fields.D = {0.1, -0.2, 0.001, 0.002, 0.05};
    const RosCameraInfo info = Read(fields, dialect);
    EXPECT_EQ(info.width, 1280u);
    EXPECT_EQ(info.distortion_model, "plumb_bob");
    EXPECT_EQ(info.D, fields.D);
    EXPECT_EQ(info.K, fields.K);
    EXPECT_EQ(info.P, fields.P);
    EXPECT_EQ(info.header.stamp, 5);
  }
}

TEST(CameraInfo, OfPlumbBobIsOpenCvsCamera) {
  InfoFields info = Wide();
  info.D = {-0.28, 0.09, 0.001, -0.0005, -0.01};
  EXPECT_LT(FarthestFromOpenCv(info, CameraOf(info)), 1e-9);
}

TEST(CameraInfo, OfARationalLensComesWithinHalfAPixel) {
  InfoFields info = Wide();
  info.model = "rational_polynomial";
  info.D = {0.1, -0.05, 0.0008, -0.0003, 0.01, 0.05, 0.01, 0};
  EXPECT_LT(FarthestFromOpenCv(info, CameraOf(info)), 0.55);
  info.D = {-0.3, 0.1, 0.001, 0, 0.02, 0, 0, 0};
  EXPECT_LT(FarthestFromOpenCv(info, CameraOf(info)), 1e-9);
}

// 14 coefficients as OAK cameras have: thin prism and tilt.
TEST(CameraInfo, OfATiltedLensComesWithinHalfAPixel) {
  InfoFields info = Wide();
  info.model = "rational_polynomial";
  info.D = {0.1, -0.05, 0.0008, -0.0003, 0.01, 0.05, 0.01,
            0,   1e-4,  -2e-5,  -1e-4,   1e-5, 1e-4, -2e-4};
  EXPECT_LT(FarthestFromOpenCv(info, CameraOf(info)), 0.55);
}

TEST(CameraInfo, OfLensesThatCannotBeWorkedWithSaysSo) {
  const auto message = [](const std::string& model, const std::vector<double>& D) {
    InfoFields info = Wide();
    info.model = model;
    info.D = D;
    return MessageOf(ErrorKind::kInput, [&] { CameraOfInfo(Read(info), false); });
  };
  EXPECT_THAT(message("rational_polynomial", {0.45, -2.6, 0, 0, 1.5, 0.33, -2.43, 1.43}),
              HasSubstr("pixels"));
  EXPECT_THAT(message("rational_polynomial", {.1, 0, 0, 0, 0, .1, 0, 0, .3, 0, 0, 0}),
              HasSubstr("not invertible"));
  EXPECT_THAT(message("rational_polynomial", {.1, 0, 0, 0, 0, .1, 0, 0, .02, 0, .02, 0}),
              HasSubstr("pixels"));
  EXPECT_THAT(message("omnidirectional", {1}), HasSubstr("`omnidirectional`"));
  EXPECT_THAT(message("plumb_bob", {std::nan("")}), HasSubstr("not finite"));
}

TEST(CameraInfo, OfAFisheyeIsOne) {
  InfoFields info = Wide();
  info.model = "equidistant";
  info.D = {0.01, -0.002, 0.001, 0};
  const RawCamera camera = CameraOf(info);
  EXPECT_EQ(camera.lens, Lens::kFisheye);
  EXPECT_EQ(camera.distortion[1], -0.002);
}

TEST(CameraInfo, OfRectifiedPicturesIsP) {
  InfoFields info = Wide();
  info.D = {-0.28, 0.09, 0, 0, 0};
  info.P = {650, 0, 630, 0, 0, 650, 350, 0, 0, 0, 1, 0};
  const RawCamera camera = CameraOf(info, true);
  EXPECT_EQ(camera.fx, 650);
  EXPECT_EQ(camera.cy, 350);
  EXPECT_EQ(camera.distortion, (std::array<double, 5>{}));
}

TEST(CameraInfo, OfBinnedPicturesIsScaled) {
  InfoFields info = Wide();
  info.binning = 2;
  const RawCamera camera = CameraOf(info);
  EXPECT_EQ(camera.width, 640);
  EXPECT_EQ(camera.fx, 350);
  EXPECT_EQ(camera.cx, 640.5 / 2 - 0.5);
}

TEST(CameraInfo, OfNoCalibrationIsNone) {
  InfoFields info;
  info.K = {};
  EXPECT_FALSE(CameraOfInfo(Read(info), false));
}

// A pair as calibrated by stereo_calibration: the same point, projected by each raw camera and by
// the rectified pair's P.
TEST(CameraInfo, OfAPairTellsWhereTheRightCameraIs) {
  const Eigen::Matrix3d turn_left = ExpSo3({0.01, -0.02, 0.005}),
                        turn_right = ExpSo3({-0.004, 0.015, 0.002});
  InfoFields left = Wide(), right = Wide();
  for (int i = 0; i < 9; ++i) {
    left.R[static_cast<size_t>(i)] = turn_left(i / 3, i % 3);
    right.R[static_cast<size_t>(i)] = turn_right(i / 3, i % 3);
  }
  left.D = right.D = {-0.2, 0.05, 0, 0, 0};
  left.P = right.P = {650, 0, 630, 0, 0, 650, 350, 0, 0, 0, 1, 0};
  right.P[3] = -650 * 0.12;
  Calibration calibration;
  calibration.left = CameraOf(left);
  ASSERT_TRUE(AddRightCamera(Read(left), Read(right), false, calibration));
  ASSERT_TRUE(calibration.right);
  const Eigen::Vector3d p_left(0.3, -0.2, 3);
  const Eigen::Vector3d p_right = calibration.T_left_right.Inverse() * p_left;
  const Eigen::Vector3d in_left = turn_left * p_left, in_right = turn_right * p_right;
  EXPECT_LT((in_left - in_right - Eigen::Vector3d(0.12, 0, 0)).norm(), 1e-12);

  Calibration rectified;
  rectified.left = CameraOf(left, true);
  ASSERT_TRUE(AddRightCamera(Read(left), Read(right), true, rectified));
  EXPECT_NEAR(rectified.baseline, 0.12, 1e-12);
  EXPECT_FALSE(rectified.right);
  right.P[3] = 0;
  EXPECT_FALSE(AddRightCamera(Read(left), Read(right), true, rectified));
}

}  // namespace
}  // namespace alidade::camera_info_test
