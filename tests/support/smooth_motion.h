// A smooth motion of an inertial sensor in closed form, and its readings.
#pragma once

#include <cmath>
#include <vector>

#include "alidade/inertial/preintegration.h"

namespace alidade {

// World: z up. The sensor turns by Exp of a smooth vector.
struct SmoothMotion {
  static Eigen::Vector3d Gravity() { return {0, 0, -9.81}; }
  static Eigen::Vector3d Position(double t) {
    return {std::sin(1.3 * t), 0.7 * std::cos(2.1 * t), 0.3 * std::sin(3 * t + 1)};
  }
  static Eigen::Vector3d Velocity(double t) {
    return {1.3 * std::cos(1.3 * t), -0.7 * 2.1 * std::sin(2.1 * t), 0.9 * std::cos(3 * t + 1)};
  }
  static Eigen::Vector3d Acceleration(double t) {
    return {-1.69 * std::sin(1.3 * t), -0.7 * 4.41 * std::cos(2.1 * t), -2.7 * std::sin(3 * t + 1)};
  }
  static Eigen::Vector3d Turn(double t) {
    return {0.8 * std::sin(1.7 * t), 0.5 * std::sin(2.3 * t + 0.4), 0.9 * std::cos(1.1 * t)};
  }
  static Eigen::Vector3d TurnRate(double t) {
    return {1.36 * std::cos(1.7 * t), 1.15 * std::cos(2.3 * t + 0.4), -0.99 * std::sin(1.1 * t)};
  }
  static ImuSample Reading(double t, const ImuBias& bias) {
    const Eigen::Matrix3d R = ExpSo3(Turn(t));
    return {t, RightJacobian(Turn(t)) * TurnRate(t) + bias.gyro,
            R.transpose() * (Acceleration(t) - Gravity()) + bias.accel};
  }
  static InertialState At(double t, const ImuBias& bias) {
    return {{ExpSo3(Turn(t)), Position(t)}, Velocity(t), bias};
  }
  static std::vector<ImuSample> Readings(double from, double to, double rate, const ImuBias& bias) {
    std::vector<ImuSample> samples;
    for (int k = 0; from + k / rate <= to; ++k) samples.push_back(Reading(from + k / rate, bias));
    return samples;
  }
};

}  // namespace alidade
