#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "alidade/io/files/camera_file.h"
#include "support/expect_camera.h"
#include "support/expect_error.h"
#include "support/temp_folder.h"

namespace alidade::opencv_calibration_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const cv::Matx33d kMatrix(532.79553123456, 0, 342.45824987654, 0, 532.91928123456, 233.90060123456,
                          0, 0, 1);
const cv::Mat_<double> kDistortion =
    (cv::Mat_<double>(1, 5) << -0.28108852, 0.02519412, 0.00121512, -0.00013312, 0.16359212);
const RawCamera kWanted = {Lens::kPinhole,
                           640,
                           480,
                           532.79553123456,
                           532.91928123456,
                           342.45824987654,
                           233.90060123456,
                           {-0.28108852, 0.02519412, 0.00121512, -0.00013312, 0.16359212}};

// Written by OpenCV itself.
std::string Written(const std::string& extension, const std::string& matrix,
                    const std::string& distortion, bool size = true) {
  cv::FileStorage file(extension, cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  file << "calibration_time"
       << "Tue 05 Mar 2024 10:11:12";
  if (size) file << "image_width" << 640 << "image_height" << 480;
  file << matrix << cv::Mat(kMatrix) << distortion << kDistortion;
  file << "avg_reprojection_error" << 0.2;
  return file.releaseAndGetString();
}

TEST(OpenCvCalibration, FilesOfFileStorageAreRead) {
  for (const char* format : {".yml", ".json", ".xml"}) {
    SCOPED_TRACE(format);
    ExpectCamera(
        ParseCameraFile(Written(format, "camera_matrix", "distortion_coefficients"), "c").left,
        kWanted);
    ExpectCamera(ParseCameraFile(Written(format, "cameraMatrix", "dist_coeffs"), "c").left,
                 kWanted);
    ExpectCamera(ParseCameraFile(Written(format, "K", "D"), "c").left, kWanted);
  }
}

TEST(OpenCvCalibration, WithoutSizeItStaysOpen) {
  const Calibration c = ParseCameraFile(Written(".yml", "K", "D", false), "c");
  EXPECT_EQ(c.left.width, 0);
  EXPECT_NEAR(c.left.fx, kWanted.fx, 1e-9);
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { RequireSize(c); }), HasSubstr("width and height"));
}

TEST(OpenCvCalibration, AFisheyeIsTold) {
  cv::FileStorage file(".yml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  file << "image_width" << 640 << "image_height" << 480 << "fisheye_model" << 1 << "camera_matrix"
       << cv::Mat(kMatrix) << "distortion_coefficients"
       << cv::Mat(cv::Vec4d(0.01, -0.02, 0.003, 1e-4));
  const Calibration c = ParseCameraFile(file.releaseAndGetString(), "c");
  EXPECT_EQ(c.left.lens, Lens::kFisheye);
  EXPECT_NEAR(c.left.distortion[1], -0.02, 1e-12);
}

TEST(OpenCvCalibration, APairIsRead) {
  const auto text = [](double unit) {
    cv::FileStorage file(".yml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
    file << "imageSize" << cv::Size(640, 480) << "M1" << cv::Mat(kMatrix) << "D1" << kDistortion
         << "M2" << cv::Mat(kMatrix) << "D2" << kDistortion << "R" << cv::Mat::eye(3, 3, CV_64F)
         << "T" << cv::Mat(cv::Vec3d(-0.06 * unit, 0.001 * unit, 0));
    return file.releaseAndGetString();
  };
  const Calibration c = ParseCameraFile(text(1), "c");
  ExpectCamera(c.left, kWanted);
  ASSERT_TRUE(c.right);
  EXPECT_LT((c.T_left_right.t - Eigen::Vector3d(0.06, -0.001, 0)).norm(), 1e-12);
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { ParseCameraFile(text(1000), "pair.yml"); }),
              AllOf(HasSubstr("OpenCV"), HasSubstr("`T`"), HasSubstr("millimeters")));
}

// 14 coefficients, with thin prism and tilt: projected by cv::projectPoints in
// bags/camera_info_test.
TEST(OpenCvCalibration, MistakesAreNamed) {
  const std::string good = Written(".yml", "camera_matrix", "distortion_coefficients");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    return MessageOf(ErrorKind::kInput, [&] { ParseCameraFile(text, "cv.yml"); });
  };
  EXPECT_THAT(with("image_height: 480", "image_heigth: 480"),
              HasSubstr("`image_height` is missing"));
  EXPECT_THAT(with("5.3279", ".Nan, 5.3279"),
              AllOf(HasSubstr("cv.yml:"), HasSubstr("`camera_matrix`")));
  EXPECT_THAT(with("-2.8108", "-1e308, 2.8108"), HasSubstr("`distortion_coefficients`"));
}

}  // namespace
}  // namespace alidade::opencv_calibration_test
