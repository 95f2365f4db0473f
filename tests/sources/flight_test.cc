// The files of a flight.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string>

#include "alidade/base/error.h"
#include "alidade/geometry/se3.h"
#include "alidade/io/files/file.h"
#include "alidade/run/sources/flight_files.h"
#include "alidade/run/sources/synth_source.h"
#include "alidade/synth/imu.h"
#include "support/temp_folder.h"

namespace alidade::flight_test {
namespace {

// One that flies a circle of radius 1.5 m in 6 s and looks outwards, nodding.
PathMotion Circle(double time) {
  static const CameraPath path = [] {
    std::vector<PathKnot> knots;
    for (int i = 0; i < 24; ++i) {
      const double angle = i * 2 * std::numbers::pi / 24;
      knots.push_back(
          {{1.5 * std::cos(angle), 1.5 * std::sin(angle), 2}, angle, 0.2 * std::sin(3 * angle)});
    }
    return CameraPath(knots, 6, 1, {}, 1);
  }();
  return path.MotionAt(time);
}

enum class Order { kFormats, kOther };

void WritePath(const std::string& file, Order order) {
  std::string text = "# t [s] tx ty tz qx qy qz qw\n";
  for (int i = 0; i < 100; ++i) {
    const Se3 pose = Circle(i * 0.05).T_world_camera;
    const Eigen::Quaterniond q = pose.Quaternion();
    char line[200];
    std::snprintf(line, sizeof(line), "%.6f %.6f %.6f %.6f", i * 0.05, pose.t.x(), pose.t.y(),
                  pose.t.z());
    text += line;
    if (order == Order::kFormats)
      std::snprintf(line, sizeof(line), " %.6f %.6f %.6f %.6f\n", q.x(), q.y(), q.z(), q.w());
    else
      std::snprintf(line, sizeof(line), " %.6f %.6f %.6f %.6f\n", q.w(), -q.x(), -q.y(), -q.z());
    text += line;
  }
  AtomicWriteFile(file, text);
}

void WriteReadings(const std::string& file) {
  std::string text = "# t [s],wx [rad/s],wy,wz,ax [m/s^2],ay,az\n";
  for (int i = -20; i < 1000; ++i) {
    const ImuSample s = PerfectReading(Circle(i * 0.005), EurocCameraImu(), i * 0.005);
    char line[300];
    std::snprintf(line, sizeof(line), "%.6f,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g\n", s.time,
                  s.angular_rate.x() + 0.02, s.angular_rate.y(), s.angular_rate.z() + 0.08,
                  s.specific_force.x(), s.specific_force.y(), s.specific_force.z());
    text += line;
  }
  AtomicWriteFile(file, text);
}

SynthSettings SettingsOf(const std::string& path, const std::string& imu) {
  SynthSettings settings = SynthDefaults(kFlightScene);
  settings.path = path;
  settings.imu = imu;
  return settings;
}

TEST(Flight, TheGyroscopeTellsWhichQuaternionsTheseAre) {
  const TempFolder folder;
  const std::string path = folder / "path.txt", imu = folder / "imu.csv";
  WriteReadings(imu);
  for (const Order order : {Order::kFormats, Order::kOther}) {
    WritePath(path, order);
    testing::internal::CaptureStderr();
    const Flight flight = ReadFlight(SettingsOf(path, imu));
    EXPECT_EQ(testing::internal::GetCapturedStderr().empty(), order == Order::kFormats);
    ASSERT_EQ(flight.poses.size(), 100u);
    EXPECT_NEAR(flight.imu.rate, 200, 1e-3);
    for (const FlightPose& pose : flight.poses)
      EXPECT_LT(RotationAngle(pose.T_world_camera, Circle(pose.time).T_world_camera), 1e-5);
  }
}

TEST(Flight, ASourceHandsImagesAndReadingsOver) {
  const TempFolder folder;
  WritePath(folder / "path.txt", Order::kFormats);
  WriteReadings(folder / "imu.csv");
  AtomicWriteFile(
      folder / "sensor.yaml",
      "T_BS:\n  cols: 4\n  rows: 4\n  data: [0, -1, 0, 0.1, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, "
      "1]\ngyroscope_noise_density: 0.0005\n");
  const std::string source =
      "synth:flight?frames=2&width=94&height=60&path=" + (folder / "path.txt") +
      "&imu=" + (folder / "imu.csv");
  const auto plain = OpenSynthSource(source);
  EXPECT_NEAR(plain->Info().camera.fx, 458 / 8.0, 0.1);
  EXPECT_LT((plain->Info().imu->T_camera_imu.t - EurocCameraImu().t).norm(), 1e-9);
  EXPECT_EQ(plain->Next()->imu.size(), 20u);  // of 0.1 s
  EXPECT_EQ(plain->Next()->imu.size(), 10u);
  EXPECT_FALSE(plain->Next().has_value());
  const auto other = OpenSynthSource(source + "&imu_model=" + (folder / "sensor.yaml"));
  EXPECT_NEAR(other->Info().imu->T_camera_imu.t.y(), 0.1, 1e-9);
  EXPECT_EQ(other->Info().imu->noise.gyro, 5e-4);
  AtomicWriteFile(folder / "imu.csv", "1,2,3\n");
  EXPECT_THROW(OpenSynthSource(source), Error);
}

// EuRoC's flights (under ALIDADE_DATA): the path turns as the gyroscope says, and the mean force in
// the world is upwards.
TEST(Flight, RealPathsAgreeWithTheirReadings) {
  const char* data = std::getenv("ALIDADE_DATA");
  if (data == nullptr) GTEST_SKIP() << "ALIDADE_DATA is not set";
  for (const std::string name : {"V102", "V203", "MH04"}) {
    const std::string folder = std::string(data) + "/euroc_flights/" + name;
    const Flight flight = ReadFlight(SettingsOf(folder + "/groundtruth.txt", folder + "/imu.csv"));
    const Eigen::Matrix3d& R_camera_imu = flight.imu.T_camera_imu.R;
    const ImuBias bias{{-0.002, 0.021, 0.077}, {0, 0, 0}};
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    double turned = 0;
    const size_t last = flight.poses.size() - 1;
    for (size_t i = 0; i < last; ++i) {
      const FlightPose &a = flight.poses[i], &b = flight.poses[i + 1];
      const Eigen::Matrix3d dR = Preintegrate(flight.readings, a.time, b.time, bias, {}).dR;
      const Se3 told{a.T_world_camera.R.transpose() * b.T_world_camera.R, {0, 0, 0}};
      turned += RotationAngle(told, {R_camera_imu * dR * R_camera_imu.transpose(), {0, 0, 0}});
      force +=
          a.T_world_camera.R * R_camera_imu * ReadingAt(flight.readings, a.time).specific_force;
    }
    EXPECT_LT(turned / static_cast<double>(last), 2e-3) << name;
    force /= static_cast<double>(last);
    EXPECT_LT((force - Eigen::Vector3d(0, 0, 9.81)).norm(), 0.3) << name;
  }
}

}  // namespace
}  // namespace alidade::flight_test
