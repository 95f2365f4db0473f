// What is believed of the motion of an inertial sensor at one moment, and where its readings alone
// lead from there: dead reckoning with covariance. An extended Kalman filter over the state and the
// common parameters of InertialFit, which starts from the result of a fit.
#pragma once

#include <Eigen/Core>
#include <span>

#include "alidade/inertial/chain_system.h"
#include "alidade/inertial/pose_measurement.h"

namespace ALIDADE_API alidade {

struct MotionBelief {
  static constexpr int kState = ChainSystem::kState, kCommon = ChainSystem::kCommon;
  static constexpr int kSize = kState + kCommon;
  using Matrix = Eigen::Matrix<double, kSize, kSize>;

  double time = 0;  // seconds, on the clock of the images
  InertialState state;
  CommonParameters common;
  // Of the increments (state; common), in the orders of pose_measurement.h.
  Matrix covariance = Matrix::Zero();

  // The same belief about the time `to` (≥ time), by readings that cover it.
  MotionBelief At(double to, std::span<const ImuSample> samples) const;
  Se3 T_world_camera() const;  // map units
  // The same with its covariance.
  TimedPose Camera(std::span<const ImuSample> samples) const;
  // Takes the measured pose of the camera at this time into account. False: it cannot be (the
  // covariance is singular), nothing is changed.
  bool See(const TimedPose& pose, std::span<const ImuSample> samples);
  // Expresses the belief in another world: p_other = T * p, T rigid, in meters.
  void Move(const Se3& T);
};

}  // namespace alidade
