// What `calibrate` writes of an inertial sensor is read again, by Alidade and as Kalibr defines it.
#include <gtest/gtest.h>

#include "alidade/geometry/se3.h"
#include "alidade/io/files/calibrations/write_calibration.h"
#include "alidade/io/files/imu_file.h"
#include "support/temp_folder.h"

namespace alidade::written_imu_test {
namespace {

Calibration OneCamera() {
  Calibration calibration;
  calibration.left.width = 640;
  calibration.left.height = 480;
  calibration.left.fx = calibration.left.fy = 500;
  calibration.left.cx = 319.5;
  calibration.left.cy = 239.5;
  return calibration;
}

ImuModel Sensor() {
  ImuModel imu;
  imu.T_camera_imu = {ExpSo3({0.3, 2.8, -0.4}), {0.03, -0.05, 0.01}};
  imu.rotation_known = imu.translation_known = imu.time_offset_known = true;
  imu.time_offset = -0.0123;
  imu.rate = 200;
  imu.noise = {2e-4, 3e-3, 4e-5, 5e-4};
  return imu;
}

class WrittenImu : public testing::Test {
 protected:
  ImuModel ReadAgain(const ImuModel& imu) {
    const std::string file = folder_.Write(
        "camera.yaml", FormatCalibration(OneCamera(), CalibrationStyle::kAlidade, "", imu).text);
    return ReadImuModel(file).value();
  }
  TempFolder folder_;
};

TEST_F(WrittenImu, IsReadAgain) {
  const ImuModel imu = Sensor(), read = ReadAgain(imu);
  EXPECT_TRUE(read.rotation_known && read.translation_known && read.time_offset_known);
  EXPECT_LT((read.T_camera_imu.R - imu.T_camera_imu.R).norm(), 1e-12);
  EXPECT_EQ(read.T_camera_imu.t, imu.T_camera_imu.t);
  EXPECT_EQ(read.time_offset, imu.time_offset);
  EXPECT_EQ(read.rate, imu.rate);
  EXPECT_EQ(read.noise.accel_walk, imu.noise.accel_walk);
}

TEST_F(WrittenImu, WithoutItsPlaceOrClockOnlyTheRotationIsKnown) {
  ImuModel imu = Sensor();
  imu.translation_known = imu.time_offset_known = false;
  const ImuModel read = ReadAgain(imu);
  EXPECT_TRUE(read.rotation_known);
  EXPECT_FALSE(read.translation_known || read.time_offset_known);
  EXPECT_LT((read.T_camera_imu.R - imu.T_camera_imu.R).norm(), 1e-12);
  EXPECT_EQ(read.T_camera_imu.t, Eigen::Vector3d::Zero());
}

TEST_F(WrittenImu, KalibrsKeysHaveItsMeaning) {
  const ImuModel imu = Sensor();
  const std::string text = FormatCalibration(OneCamera(), CalibrationStyle::kKalibr, "", imu).text;
  const size_t at = text.find("  T_cam_imu:\n  - [");  // maps points of the sensor into the camera
  ASSERT_NE(at, std::string::npos);
  EXPECT_NEAR(std::stod(text.substr(at + 18)), imu.T_camera_imu.R(0, 0), 1e-12);
  const size_t shift = text.find("timeshift_cam_imu: ");  // t_imu = t_cam + shift
  ASSERT_NE(shift, std::string::npos);
  EXPECT_NEAR(std::stod(text.substr(shift + 19)), imu.time_offset, 1e-12);
}

}  // namespace
}  // namespace alidade::written_imu_test
