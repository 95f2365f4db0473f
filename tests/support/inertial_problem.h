// A phone in smooth motion, seen by a camera of unknown unit: noisy poses and readings.
#pragma once

#include <cmath>
#include <vector>

#include "alidade/base/random.h"
#include "alidade/inertial/inertial_fit.h"
#include "support/smooth_motion.h"

namespace alidade {

struct InertialTruth {
  double scale = 0.4;  // meters per map unit
  double time_offset = 0.023;
  ImuBias bias{{0.02, -0.01, 0.03}, {0.1, -0.15, 0.05}};
  Se3 T_camera_imu{ExpSo3({0.3, 2.8, -0.4}), {0.03, -0.05, 0.01}};
  Eigen::Matrix3d R_map_world = ExpSo3({0.7, -0.3, 1.1});

  // Of the camera at `time` of the images, in map units.
  Se3 CameraAt(double time) const {
    const Se3 T = SmoothMotion::At(time + time_offset, {}).T_world_imu * T_camera_imu.Inverse();
    return {R_map_world * T.R, R_map_world * T.t / scale};
  }
};

struct InertialProblem {
  std::vector<TimedPose> poses;
  std::vector<ImuSample> samples;

  // Poses at 8 Hz with 4 mm and 0.001 rad of noise until `seconds`, readings at 200 Hz with the
  // noise of a phone until `seconds` + `more`.
  InertialProblem(const InertialTruth& truth, double seconds, uint64_t seed, double more = 0.3) {
    Random random(seed, 1);
    const auto noise = [&random](double sigma) -> Eigen::Vector3d {
      return sigma * Eigen::Vector3d(random.Gaussian(), random.Gaussian(), random.Gaussian());
    };
    samples = SmoothMotion::Readings(-0.3, seconds + more, 200, truth.bias);
    for (ImuSample& sample : samples) {
      sample.angular_rate += noise(5e-4 * std::sqrt(200.0));
      sample.specific_force += noise(0.02 * std::sqrt(200.0));
    }
    constexpr double kPosition = 0.004, kRotation = 0.001;
    for (double t = 0; t <= seconds; t += 0.125) {
      const Se3 T = truth.CameraAt(t);
      TimedPose pose;
      pose.time = t;
      pose.T_world_camera.R = T.R * ExpSo3(noise(kRotation));
      pose.T_world_camera.t = T.t + truth.R_map_world * noise(kPosition) / truth.scale;
      pose.covariance.diagonal() << Eigen::Vector3d::Constant(std::pow(kPosition / truth.scale, 2)),
          Eigen::Vector3d::Constant(kRotation * kRotation);
      poses.push_back(pose);
    }
  }
};

}  // namespace alidade
