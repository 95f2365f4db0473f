// The simulated inertial sensor: the path's derivatives, what a sensor reads, its errors.
#include "alidade/synth/imu.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/synth/recording.h"
#include "alidade/synth/scenes/scenes.h"

namespace alidade::synth_imu_test {
namespace {

using Eigen::Vector3d;

CameraPath PathOf(const std::string& scene, uint64_t seed, const PathTiming& timing = {}) {
  SceneBuilder builder(seed);
  const Layout layout = LayOut(scene, builder);
  return {layout.knots, layout.period, layout.turns, layout.shake, seed, timing};
}

std::vector<std::pair<const char*, CameraPath>> Paths() {
  PathTiming fast, turn;
  fast.speed = 2.5;
  turn.turn_first = 4;
  return {{"room", PathOf("room", 3, fast)}, {"turn-walk", PathOf("desk", 2, turn)}};
}

SimulatedImu SensorOn(const CameraPath& path, SynthSettings settings, double seconds = 20) {
  settings.Check();
  return {settings, seconds, [&path](double time) { return path.MotionAt(time); }};
}

SynthSettings With(const std::string& imu, double rate = 0, uint64_t seed = 1) {
  SynthSettings settings;
  settings.imu = imu;
  settings.imu_rate = rate;
  settings.seed = seed;
  return settings;
}

// Rotation vector from time a to time b, in the camera's axes.
Vector3d Turned(const CameraPath& path, double a, double b) {
  return LogSo3(path.At(a).R.transpose() * path.At(b).R);
}

TEST(SynthImu, MotionIsTheDerivativeOfThePath) {
  const double h = 2e-4;
  for (const auto& [name, path] : Paths()) {
    // The third derivative of the path jumps at knots.
    for (double t = -0.05; t < 8; t += 0.173) {
      const PathMotion motion = path.MotionAt(t);
      const Se3 before = path.At(t - h), at = path.At(t), after = path.At(t + h);
      EXPECT_LT((motion.T_world_camera.t - at.t).norm(), 1e-12);
      EXPECT_LT((motion.velocity - (after.t - before.t) / (2 * h)).norm(), 1e-5) << name << t;
      const Vector3d acceleration = (after.t - 2 * at.t + before.t) / (h * h);
      EXPECT_LT((motion.acceleration - acceleration).norm(), 1e-2) << name << t;
      const Vector3d rate = Turned(path, t - h, t + h) / (2 * h);
      EXPECT_LT((motion.angular_rate - rate).norm(), 1e-5) << name << t;
      const Vector3d faster = (Turned(path, t, t + h) - Turned(path, t - h, t)) / (h * h);
      EXPECT_LT((motion.angular_acceleration - faster).norm(), 1e-2) << name << t;
    }
  }
}

TEST(SynthImu, IntegratedReadingsAreThePath) {
  for (const auto& [name, path] : Paths()) {
    const SimulatedImu sensor = SensorOn(path, With("ideal", 1000));
    const Se3& T_camera_imu = sensor.truth().T_camera_imu;
    EXPECT_GT(T_camera_imu.t.norm(), 0.05);
    const auto samples = sensor.Between(-0.1, 8);
    const auto position = [&, &path = path](double t) -> Vector3d {
      return path.At(t) * T_camera_imu.t;
    };
    for (double t = 0; t < 7; t += 0.9) {
      InertialState state;
      state.T_world_imu = path.At(t) * T_camera_imu;
      state.velocity = (position(t + 1e-4) - position(t - 1e-4)) / 2e-4;
      const Preintegration motion = Preintegrate(samples, t, t + 1, {}, {});
      const InertialState after = Predict(state, motion, kSynthGravity);
      const Se3 truth = path.At(t + 1) * T_camera_imu;
      EXPECT_LT((after.T_world_imu.t - truth.t).norm(), 1e-4) << name << t;
      EXPECT_LT(RotationAngle(after.T_world_imu, truth), 3e-6) << name << t;
    }
  }
}

TEST(SynthImu, AtRestItReadsGravityUpwards) {
  const CameraPath still({{{1, 2, 1.5}, 0.4, 0}}, 10, 0, {0, 0, 1}, 1);
  const auto samples = SensorOn(still, With("phone", 200)).Between(0, 10);
  Vector3d mean = Vector3d::Zero();
  for (const ImuSample& sample : samples)
    mean += sample.specific_force / static_cast<double>(samples.size());
  // A phone that lies on its right side, top to the left: its x axis points up.
  EXPECT_NEAR(mean.x(), 9.81, 0.17);
  EXPECT_NEAR(mean.y(), 0, 0.6);  // within some degrees
  EXPECT_NEAR(mean.z(), 0, 0.6);
}

TEST(SynthImu, ErrorsAreThoseOfTheSensor) {
  const CameraPath path = PathOf("desk", 1);
  const double seconds = 400;
  const SimulatedImu sensor = SensorOn(path, With("adis"), seconds);
  const ImuNoise& noise = sensor.truth().noise;
  double gyro = 0, accel = 0;
  const auto samples = sensor.Between(0, 20);
  ASSERT_NEAR(samples.size(), 4000, 1);
  for (const ImuSample& sample : samples) {
    const ImuSample perfect =
        PerfectReading(path.MotionAt(sample.time), sensor.truth().T_camera_imu, sample.time);
    const ImuBias bias = sensor.BiasAt(sample.time);
    gyro += (sample.angular_rate - perfect.angular_rate - bias.gyro).squaredNorm();
    accel += (sample.specific_force - perfect.specific_force - bias.accel).squaredNorm();
  }
  const double values = 3.0 * static_cast<double>(samples.size());
  EXPECT_NEAR(std::sqrt(gyro / values / 200), noise.gyro, 0.05 * noise.gyro);
  EXPECT_NEAR(std::sqrt(accel / values / 200), noise.accel, 0.05 * noise.accel);
  EXPECT_LT((sensor.BiasAt(0).gyro - Vector3d(-0.002, 0.021, 0.077)).norm(), 1e-3);
  double gyro_walk = 0, accel_walk = 0;
  for (int t = 0; t < seconds; ++t) {
    const ImuBias a = sensor.BiasAt(t), b = sensor.BiasAt(t + 1);
    gyro_walk += (b.gyro - a.gyro).squaredNorm() / 3 / seconds;
    accel_walk += (b.accel - a.accel).squaredNorm() / 3 / seconds;
  }
  EXPECT_NEAR(std::sqrt(gyro_walk), noise.gyro_walk, 0.1 * noise.gyro_walk);
  EXPECT_NEAR(std::sqrt(accel_walk), noise.accel_walk, 0.1 * noise.accel_walk);
}

TEST(SynthImu, APhonesClockAndRotationAreUnknown) {
  const CameraPath path = PathOf("desk", 1);
  double least = 0, most = 0;
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const SimulatedImu sensor = SensorOn(path, With("phone", seed % 2 == 0 ? 200 : 0, seed));
    const ImuModel& told = sensor.told();
    EXPECT_FALSE(told.rotation_known || told.translation_known || told.time_offset_known);
    EXPECT_EQ(told.time_offset, 0);
    least = std::min(least, sensor.truth().time_offset);
    most = std::max(most, sensor.truth().time_offset);
    EXPECT_NEAR(sensor.BiasAt(0).gyro.norm(), 0.02, 1e-3);
    EXPECT_NEAR(sensor.BiasAt(0).accel.norm(), 0.15, 1e-2);
    const auto samples = sensor.Between(0, 10);
    ASSERT_NEAR(samples.size(), 10 * sensor.truth().rate, 1);
    bool even = true;
    for (size_t i = 1; i < samples.size(); ++i) {
      const double step = samples[i].time - samples[i - 1].time;
      EXPECT_GT(step, 0);
      even = even && std::abs(step - 1 / sensor.truth().rate) < 1e-4;
    }
    EXPECT_FALSE(even);
  }
  EXPECT_LT(least, -2e-3);
  EXPECT_GT(most, 2e-3);
  EXPECT_LT(most - least, 0.06);
}

TEST(SynthImu, AnOffsetIsAddedToTheStamps) {
  const CameraPath path = PathOf("desk", 1);
  SynthSettings settings = With("ideal");
  const auto exact = SensorOn(path, settings).Between(-0.0025, 2);
  settings.imu_offset = 20;
  const SimulatedImu shifted = SensorOn(path, settings);
  EXPECT_EQ(shifted.truth().time_offset, 0.02);
  const auto late = shifted.Between(0.0175, 2.02);
  ASSERT_EQ(late.size(), exact.size());
  for (size_t i = 0; i < late.size(); ++i) {
    EXPECT_NEAR(late[i].time, exact[i].time + 0.02, 1e-12);
    EXPECT_EQ(late[i].specific_force, exact[i].specific_force);
  }
}

TEST(SynthImu, PicturesAreTheSameWithAndWithout) {
  SynthSettings settings;
  settings.scene = "table";
  settings.frames = 2;
  settings.width = 160;
  settings.height = 120;
  const RenderedFrame without = SynthRecording(settings).Render(1);
  settings.imu = "phone";
  const SynthRecording recording(settings);
  ASSERT_NE(recording.imu(), nullptr);
  EXPECT_EQ(cv::norm(without.image, recording.Render(1).image, cv::NORM_INF), 0);
}

TEST(SynthImu, SettingsSayWhatCannotBe) {
  EXPECT_THROW(With("adus").Check(), Error);
  EXPECT_THROW(With("off", 200).Check(), Error);
  EXPECT_THROW(With("phone", 3).Check(), Error);
  SynthSettings settings;
  settings.imu_offset = 10;
  EXPECT_THROW(settings.Check(), Error);
}

}  // namespace
}  // namespace alidade::synth_imu_test
