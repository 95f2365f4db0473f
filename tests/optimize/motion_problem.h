// A bundle problem with the readings of an inertial sensor along the path of its cameras.
#pragma once

#include <cmath>
#include <vector>

#include "alidade/inertial/preintegration.h"
#include "alidade/optimize/bundle_adjustment.h"
#include "problems/bundle_problem.h"

namespace alidade {

struct MotionProblemOptions {
  BundleProblemOptions bundle{
      .scene = BundleScene::kRing, .fixed_cameras = 1, .free_cameras = 20, .stereo = 0};
  double seconds = 8;  // along the whole path
  ImuNoise noise;      // of the readings
  ImuBias bias;        // of the readings; that of the gyroscope is known
  double accel_bias_sigma = 0.2;
};

// Motion of the sensor along the path of BundleScene::kRing, by differences of the analytic path.
struct MotionPath {
  double path_length = 4, seconds = 8;
  Se3 T_camera_imu{ExpSo3({0.3, -1.2, 0.5}), {0.03, -0.05, 0.02}};

  Se3 ImuAt(double time) const {
    return BundleCameraAt(BundleScene::kRing, path_length, time / seconds).Inverse() * T_camera_imu;
  }
  Eigen::Vector3d VelocityAt(double time) const {
    constexpr double kStep = 1e-3;
    return (ImuAt(time + kStep).t - ImuAt(time - kStep).t) / (2 * kStep);
  }
  ImuSample ReadingAt(double time, const Eigen::Vector3d& gravity) const {
    constexpr double kStep = 1e-3;
    const Eigen::Vector3d turn =
        LogSo3(ImuAt(time - kStep).R.transpose() * ImuAt(time + kStep).R) / (2 * kStep);
    const Eigen::Vector3d acceleration =
        (VelocityAt(time + kStep) - VelocityAt(time - kStep)) / (2 * kStep);
    return {time, turn, ImuAt(time).R.transpose() * (acceleration - gravity)};
  }
};

// Cameras are in order of time. The velocities start at zero.
inline BundleProblem MakeMotionProblem(const MotionProblemOptions& options) {
  BundleProblem problem = MakeBundleProblem(options.bundle);
  Random random(options.bundle.seed + 100);
  const MotionPath path{options.bundle.path_length, options.seconds};
  BundleMotion& motion = problem.motion;
  motion.T_camera_imu = path.T_camera_imu;
  motion.gravity = {1.2, 9.6, 1.6};
  constexpr double kRate = 200;
  std::vector<ImuSample> readings;
  for (double time = 0; time <= options.seconds; time += 1 / kRate) {
    ImuSample reading = path.ReadingAt(time, motion.gravity);
    reading.angular_rate +=
        options.bias.gyro + RandomVector(random, options.noise.gyro * std::sqrt(kRate));
    reading.specific_force +=
        options.bias.accel + RandomVector(random, options.noise.accel * std::sqrt(kRate));
    readings.push_back(reading);
  }
  const int cameras = static_cast<int>(problem.fixed.size());
  for (int i = 0; i < cameras; ++i) {
    BundleMotionState state;
    state.camera = i;
    state.accel_bias_sigma = i == 0 ? options.accel_bias_sigma : 0;
    motion.states.push_back(state);
    if (i == 0) continue;
    BundleMotionLink link;
    link.from = i - 1;
    link.to = i;
    const double from = options.seconds * (i - 0.5) / cameras;
    link.motion = Preintegrate(readings, from, from + options.seconds / cameras,
                               {options.bias.gyro, Eigen::Vector3d::Zero()}, options.noise);
    link.covariance = link.motion.covariance;
    link.accel_walk = 1e-3 * std::sqrt(link.motion.seconds);
    motion.links.push_back(link);
  }
  return problem;
}

}  // namespace alidade
