#include "alidade/synth/imu.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "alidade/base/random.h"

namespace alidade {
namespace {

using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kWalkStart = -1;   // seconds; the random walk of the bias is 0 there
constexpr double kWalkStep = 0.25;  // seconds; in between the bias is interpolated
// Random streams of the sensor (base/random.h): its build, the walk of its bias, its readings.
constexpr uint64_t kBuildStream = 71, kWalkStream = 72, kReadingStream = 73;

uint64_t HashOf(uint64_t x) {  // SplitMix64 (Steele et al. 2014)
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

Vector3d Gaussian3(Random& random) {
  const double x = random.Gaussian(), y = random.Gaussian(), z = random.Gaussian();
  return {x, y, z};
}

Vector3d RoundTo(double step, const Vector3d& value) {
  if (step == 0) return value;
  return step * (value / step).array().round().matrix();
}

// A phone's axes: x right, y up, z to the user, as its screen is read upright. It is held upright
// for an upright picture, else with its top to the left. The camera is near the top of the back,
// the sensor some centimetres below it, and mounted within a degree or so.
Se3 PhoneCameraImu(bool upright, Random& random) {
  Se3 T_camera_phone;
  if (upright)
    T_camera_phone.R << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  else
    T_camera_phone.R << 0, -1, 0, -1, 0, 0, 0, 0, -1;
  const double across = random.Uniform(-0.02, 0.02), down = random.Uniform(0.01, 0.06),
               deep = random.Uniform(-0.004, 0.004);
  const Vector3d mounted = 0.5 * kDegree * Gaussian3(random);
  return T_camera_phone * Se3{ExpSo3(mounted), {across, -down, deep}};
}

}  // namespace

Se3 EurocCameraImu() {
  Se3 T_imu_camera;                                                      // T_BS of cam0
  T_imu_camera.R << 0.0148655429818, -0.999880929698, 0.00414029679422,  //
      0.999557249008, 0.0149672133247, 0.025715529948,                   //
      -0.0257744366974, 0.00375618835797, 0.999660727178;
  T_imu_camera.t << -0.0216401454975, -0.064676986768, 0.00981073058949;
  return Se3::FromQuaternion(T_imu_camera.Quaternion(), T_imu_camera.t).Inverse();
}

ImuNoise EurocImuNoise() {
  return {.gyro = 1.7e-4, .accel = 2e-3, .gyro_walk = 1.9e-5, .accel_walk = 3e-3};
}

ImuSample PerfectReading(const PathMotion& motion, const Se3& T_camera_imu, double time) {
  const Vector3d& w = motion.angular_rate;
  const Vector3d& arm = T_camera_imu.t;
  // In the camera's axes.
  const Vector3d force =
      motion.T_world_camera.R.transpose() * (motion.acceleration - kSynthGravity) +
      motion.angular_acceleration.cross(arm) + w.cross(w.cross(arm));
  const Eigen::Matrix3d R_imu_camera = T_camera_imu.R.transpose();
  return {time, R_imu_camera * w, R_imu_camera * force};
}

SimulatedImu::SimulatedImu(const SynthSettings& settings, double seconds,
                           std::function<PathMotion(double)> motion)
    : motion_(std::move(motion)), seed_(settings.seed) {
  Random random(seed_, kBuildStream);
  const bool phone = settings.imu == "phone", ideal = settings.imu == "ideal";
  truth_.rotation_known = truth_.translation_known = truth_.time_offset_known = true;
  truth_.rate = settings.ImuRate();
  if (phone) {
    truth_.T_camera_imu = PhoneCameraImu(settings.height > settings.width, random);
    errors_.bias.gyro = 0.02 * Gaussian3(random).normalized();
    errors_.bias.accel = 0.15 * Gaussian3(random).normalized();
    truth_.time_offset = 1e-3 * settings.imu_offset.value_or(random.Uniform(-30, 30));
    truth_.noise = {.gyro = 7e-4, .accel = 5e-3, .gyro_walk = 3e-5, .accel_walk = 5e-4};
    errors_.jitter = std::min(2e-3, 0.4 / truth_.rate);
    // A browser rounds to 0.1 °/s and 0.1 m/s² (W3C, Device Orientation and Motion); an app reads
    // the sensor's own steps: ±2000 °/s and ±8 g in 16 bits.
    const bool browser = truth_.rate <= 60;
    errors_.gyro_step = kDegree * (browser ? 0.1 : 4000.0 / 65536);
    errors_.accel_step = browser ? 0.1 : 16 * 9.81 / 65536;
    told_.rate = truth_.rate;
  } else {
    truth_.T_camera_imu = EurocCameraImu();
    truth_.time_offset = 1e-3 * settings.imu_offset.value_or(0);
    truth_.noise = EurocImuNoise();
    if (!ideal) errors_.bias = {{-0.002, 0.021, 0.077}, {-0.02, 0.09, 0.04}};
    told_ = truth_;
  }
  errors_.noisy = !ideal;
  errors_.noise = truth_.noise;

  Random wander(seed_, kWalkStream);
  const int steps = 2 + static_cast<int>(std::ceil((seconds + 1 - kWalkStart) / kWalkStep));
  walk_.resize(errors_.noisy ? steps : 1);
  for (size_t i = 1; i < walk_.size(); ++i) {
    const double root = std::sqrt(kWalkStep);
    walk_[i].gyro = walk_[i - 1].gyro + root * errors_.noise.gyro_walk * Gaussian3(wander);
    walk_[i].accel = walk_[i - 1].accel + root * errors_.noise.accel_walk * Gaussian3(wander);
  }
}

ImuBias SimulatedImu::BiasAt(double time) const {
  const double last = static_cast<double>(walk_.size() - 1);
  const double s = std::clamp((time - kWalkStart) / kWalkStep, 0.0, last);
  const size_t i = static_cast<size_t>(s), next = std::min(i + 1, walk_.size() - 1);
  const double share = s - std::floor(s);
  return {errors_.bias.gyro + walk_[i].gyro + share * (walk_[next].gyro - walk_[i].gyro),
          errors_.bias.accel + walk_[i].accel + share * (walk_[next].accel - walk_[i].accel)};
}

ImuSample SimulatedImu::Reading(long number) const {
  const double time = static_cast<double>(number) / truth_.rate;
  ImuSample sample = PerfectReading(motion_(time), truth_.T_camera_imu, time + truth_.time_offset);
  if (!errors_.noisy) return sample;
  // One generator for each reading: they can be made in any order.
  Random random(HashOf(HashOf(seed_) + static_cast<uint64_t>(number)), kReadingStream);
  const double root = std::sqrt(truth_.rate);
  const ImuBias bias = BiasAt(time);
  sample.angular_rate += bias.gyro + root * errors_.noise.gyro * Gaussian3(random);
  sample.specific_force += bias.accel + root * errors_.noise.accel * Gaussian3(random);
  sample.angular_rate = RoundTo(errors_.gyro_step, sample.angular_rate);
  sample.specific_force = RoundTo(errors_.accel_step, sample.specific_force);
  sample.time += random.Uniform(-1, 1) * errors_.jitter;
  return sample;
}

std::vector<ImuSample> SimulatedImu::Between(double after, double until) const {
  std::vector<ImuSample> samples;
  const auto number = [this](double time) { return (time - truth_.time_offset) * truth_.rate; };
  // Stamps are wrong by less than half an interval.
  const long first = static_cast<long>(std::floor(number(after))) - 1;
  const long last = static_cast<long>(std::ceil(number(until))) + 1;
  for (long i = first; i <= last; ++i) {
    const ImuSample sample = Reading(i);
    if (sample.time > after && sample.time <= until) samples.push_back(sample);
  }
  return samples;
}

}  // namespace alidade
