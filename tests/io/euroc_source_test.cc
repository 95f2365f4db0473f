#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/features2d.hpp>

#include "alidade/io/files/open_source.h"
#include "support/expect_error.h"
#include "support/tiny_recording.h"

namespace alidade::euroc_source_test {
namespace {

using testing::HasSubstr;

std::string SensorYaml(double x, const std::string& more =
                                     "distortion_model: radial-tangential\n"
                                     "distortion_coefficients: [0, 0, 0, 0]\n") {
  return "%YAML:1.0\n# camera\nsensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1, 0, "
         "0, " +
         std::to_string(x) +
         ",\n         0, 1, 0, 0,\n         0, 0, 1, 0,\n         0, 0, 0, 1]\nrate_hz: "
         "20\nresolution: [64, 48]\n"
         "camera_model: pinhole\nintrinsics: [60, 60, 31.5, 23.5]\n" +
         more;
}

// Stamps start at 2 s with steps of 50 ms; the right camera's are 10 µs later.
void WriteTinyEuroc(const TempFolder& folder, int frames, bool right = true) {
  for (int cam = 0; cam < (right ? 2 : 1); ++cam) {
    const std::string root = "mav0/cam" + std::to_string(cam);
    folder.Folder(root + "/data");
    std::string list = "#timestamp [ns],filename\n";
    for (int i = 0; i < frames; ++i) {
      const std::string name = std::to_string(2000000000LL + 50000000LL * i + 10000 * cam);
      WriteImage(folder / (root + "/data/" + name + ".png"), TinyImage(10 * i + cam));
      list += name + "," + name + ".png\r\n";
    }
    folder.Write(root + "/data.csv", list);
    folder.Write(root + "/sensor.yaml", SensorYaml(0.11 * cam));
  }
}

TEST(EurocSource, PairsTheImagesAndKeepsTheStamps) {
  const TempFolder folder;
  WriteTinyEuroc(folder, 3);
  const auto source = OpenSource(folder.path());
  EXPECT_EQ(source->Info().kind, "euroc");
  EXPECT_EQ(source->Info().sensor, Sensor::kStereo);
  EXPECT_NEAR(source->Info().camera.baseline, 0.11, 1e-9);
  EXPECT_EQ(source->Info().camera.fps, 20);
  EXPECT_TRUE(source->Info().R_camera_rectified.isApprox(Eigen::Matrix3d::Identity(), 1e-12));
  for (int i = 0; i < 3; ++i) {
    const auto frame = source->Next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->stamp, i == 0 ? "2.000000000" : i == 1 ? "2.050000000" : "2.100000000");
    // Equal undistorted cameras with parallel axes: rectification changes nothing.
    EXPECT_LE(cv::norm(frame->image, TinyImage(10 * i), cv::NORM_INF), 1);
    EXPECT_LE(cv::norm(frame->right, TinyImage(10 * i + 1), cv::NORM_INF), 1);
  }
  EXPECT_FALSE(source->Next());
}

// Readings every 5 ms from 1.8 s on; their angular rate about x counts them.
void WriteTinyImu(const TempFolder& folder, int readings) {
  folder.Folder("mav0/imu0");
  std::string list =
      "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
      "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\r\n";
  for (int i = 0; i < readings; ++i)
    list += std::to_string(1800000000LL + 5000000LL * i) + "," + std::to_string(0.001 * i) +
            ",0.2,0.3,9.7,-0.5,1.1\r\n";
  folder.Write("mav0/imu0/data.csv", list);
  folder.Write("mav0/imu0/sensor.yaml",
               "sensor_type: imu\nT_BS:\n  cols: 4\n  rows: 4\n  data: [0, -1, 0, 0.01, 1, 0, 0, "
               "0.02, 0, 0, 1, 0.03, 0, 0, 0, 1]\nrate_hz: 200\ngyroscope_noise_density: 1.7e-4\n"
               "gyroscope_random_walk: 2e-5\naccelerometer_noise_density: 2e-3\n"
               "accelerometer_random_walk: 3e-3\n");
}

TEST(EurocSource, GivesEachFrameTheReadingsSinceTheLastOne) {
  const TempFolder folder;
  WriteTinyEuroc(folder, 4, false);
  folder.Write("mav0/cam0/sensor.yaml", SensorYaml(0.5));
  WriteTinyImu(folder, 100);
  const auto source = OpenSource(folder.path());
  ASSERT_TRUE(source->Info().imu);
  const ImuModel& imu = *source->Info().imu;
  EXPECT_TRUE(imu.rotation_known && imu.translation_known && imu.time_offset_known);
  EXPECT_EQ(imu.rate, 200);
  EXPECT_EQ(imu.noise.gyro, 1.7e-4);
  EXPECT_EQ(imu.noise.accel_walk, 3e-3);
  Eigen::Matrix3d R;
  R << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  EXPECT_TRUE(imu.T_camera_imu.R.isApprox(R));
  EXPECT_TRUE(imu.T_camera_imu.t.isApprox(Eigen::Vector3d(0.01 - 0.5, 0.02, 0.03)));
  // Two passes: a seek starts again.
  for (int pass = 0; pass < 2; ++pass) {
    int next = 0;
    for (int i = 0; i < 4; ++i) {
      const auto frame = source->Next();
      ASSERT_FALSE(frame->imu.empty());
      if (i == 0) {
        EXPECT_NEAR(frame->imu.front().time, 1.9, 0.006);
        next = static_cast<int>(std::lround((frame->imu.front().time - 1.8) / 0.005));
      }
      for (const ImuSample& sample : frame->imu) {
        EXPECT_NEAR(sample.angular_rate.x(), 0.001 * next, 1e-9);
        EXPECT_NEAR(sample.time, 1.8 + 0.005 * next, 1e-6);
        EXPECT_TRUE(sample.specific_force.isApprox(Eigen::Vector3d(9.7, -0.5, 1.1)));
        ++next;
      }
      EXPECT_GE(frame->imu.back().time, frame->time);
    }
    EXPECT_TRUE(source->Seek(0));
  }
  // A clip starts with its own past.
  const auto clip = OpenSource(folder.path(), {.first = 2});
  EXPECT_NEAR(clip->Next()->imu.front().time, 2.0, 0.006);
  const auto off = OpenSource(folder.path(), {.imu = "off"});
  EXPECT_FALSE(off->Info().imu);
  EXPECT_TRUE(off->Next()->imu.empty());
}

// Rectification turns the camera towards the slanted baseline.
TEST(EurocSource, TurnsTheSensorWithTheRectification) {
  const TempFolder folder;
  WriteTinyEuroc(folder, 2);
  WriteTinyImu(folder, 100);
  std::string right = SensorYaml(0.1);
  right.replace(right.find("0, 1, 0, 0,"), 11, "0, 1, 0, 0.04,");  // a slanted pair
  folder.Write("mav0/cam1/sensor.yaml", right);
  const auto source = OpenSource(folder.path());
  const Eigen::Matrix3d R_camera_rectified = source->Info().R_camera_rectified;
  ASSERT_GT((R_camera_rectified - Eigen::Matrix3d::Identity()).norm(), 0.1);
  const Eigen::Vector3d p_imu(0.3, -0.2, 1);
  const Eigen::Vector3d p_mounted(0.2 + 0.01, 0.3 + 0.02, 1.03);  // T_BS of the sensor, by hand
  EXPECT_TRUE(
      (R_camera_rectified * (source->Info().imu->T_camera_imu * p_imu)).isApprox(p_mounted, 1e-9));
}

TEST(EurocSource, MonoKeepsTheLensInTheCamera) {
  const TempFolder folder;
  WriteTinyEuroc(folder, 2);
  folder.Write("mav0/cam0/sensor.yaml",
               SensorYaml(0,
                          "distortion_model: radial-tangential\ndistortion_coefficients: [-0.28, "
                          "0.07, 0.0002, 1e-5]\n"));
  const auto source = OpenSource(folder.path(), {.sensor = Sensor::kMono});
  EXPECT_EQ(source->Info().camera.distortion,
            (std::array<double, 5>{-0.28, 0.07, 0.0002, 1e-5, 0}));
  EXPECT_EQ(source->Info().camera.baseline, 0);
  const auto frame = source->Next();
  EXPECT_EQ(cv::norm(frame->image, TinyImage(0), cv::NORM_INF), 0);
  EXPECT_TRUE(frame->right.empty());
}

TEST(EurocSource, WithoutSecondCameraIsMono) {
  const TempFolder folder;
  WriteTinyEuroc(folder, 2, false);
  EXPECT_EQ(OpenSource(folder.path())->Info().sensor, Sensor::kMono);
  EXPECT_EQ(OpenSource(folder / "mav0")->Info().sensor, Sensor::kMono);
}

TEST(EurocSource, AFrameWithoutPartnerIsStillAPicture) {
  const TempFolder folder;
  WriteTinyEuroc(folder, 3);
  folder.Write("mav0/cam1/data.csv", "2000000000,2000010000.png\n2100010000,2100010000.png\n");
  WarningCatcher warnings;
  const auto source = OpenSource(folder.path());
  EXPECT_THAT(warnings.text(), HasSubstr("1 of 3 frames have no right image"));
  for (const bool right : {true, false, true}) {
    const auto frame = source->Next();
    EXPECT_FALSE(frame->image.empty());
    EXPECT_EQ(frame->right.empty(), !right);
  }
}

TEST(EurocSource, CalibrationsThatCannotBeAreNamed) {
  const TempFolder folder;
  WriteTinyEuroc(folder, 2);
  const auto message = [&](const std::string& yaml) {
    folder.Write("mav0/cam0/sensor.yaml", yaml);
    return MessageOf(ErrorKind::kInput, [&] { OpenSource(folder.path()); });
  };
  EXPECT_THAT(message(SensorYaml(0, "distortion_model: omni\n")),
              HasSubstr("sensor.yaml:15: distortion_model"));
  EXPECT_THAT(message("%YAML:1.0\ncamera_model: pinhole\n"), HasSubstr("`resolution` is missing"));
  EXPECT_THAT(message(SensorYaml(0.5)), HasSubstr("swapped"));
  EXPECT_THAT(message("a: [1,\n"), HasSubstr("sensor.yaml:"));
}

TEST(EurocSource, RowsOfTheRealPairAgree) {
  if (DataFolder().empty()) GTEST_SKIP() << "needs ALIDADE_DATA";
  const auto source = OpenSource(DataFolder() + "/euroc_micro");
  EXPECT_EQ(source->Info().frames, 24);
  EXPECT_EQ(source->Info().sensor, Sensor::kStereo);
  EXPECT_NEAR(source->Info().camera.baseline, 0.11, 0.001);
  const auto frame = source->Next();
  EXPECT_EQ(frame->stamp, "1403715273.262142976");

  const auto orb = cv::ORB::create(2000);
  std::vector<cv::KeyPoint> left, right;
  cv::Mat left_descriptors, right_descriptors;
  orb->detectAndCompute(frame->image, cv::noArray(), left, left_descriptors);
  orb->detectAndCompute(frame->right, cv::noArray(), right, right_descriptors);
  std::vector<cv::DMatch> matches;
  cv::BFMatcher(cv::NORM_HAMMING, true).match(left_descriptors, right_descriptors, matches);
  std::vector<double> rows, disparities;
  for (const cv::DMatch& match : matches) {
    if (match.distance > 40) continue;
    const cv::Point2f l = left[static_cast<size_t>(match.queryIdx)].pt,
                      r = right[static_cast<size_t>(match.trainIdx)].pt;
    if (std::abs(l.y - r.y) > 10) continue;  // a wrong match
    rows.push_back(l.y - r.y);
    disparities.push_back(l.x - r.x);
  }
  ASSERT_GT(rows.size(), 200u);
  const auto median = [](std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2),
                     values.end());
    return values[values.size() / 2];
  };
  EXPECT_LT(std::abs(median(rows)), 0.3);  // no offset
  for (double& row : rows) row = std::abs(row);
  RecordProperty("median_row_difference", std::to_string(median(rows)));
  EXPECT_LT(median(rows), 0.5);
  EXPECT_GT(median(disparities), 1);  // the scene is in front of the camera
}

}  // namespace
}  // namespace alidade::euroc_source_test
