// The readings of an inertial sensor that is fixed to the camera, in bundle adjustment: between
// cameras that follow each other in time the preintegrated motion is one more measurement (Forster,
// Carlone, Dellaert & Scaramuzza 2017, §VI). Lengths are meters and gravity is known.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/geometry/se3.h"
#include "alidade/inertial/preintegration.h"

namespace ALIDADE_API alidade {

// What is unknown of the sensor at the time of one camera, beside its pose. It has a link.
struct BundleMotionState {
  int camera = -1;  // index
  // Of the sensor, in the world, m/s. Initial value and result.
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  // Initial value and result, m/s². Its prior is the initial value with this standard deviation; 0:
  // it has no prior of its own. One state of each chain of links needs one.
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();
  double accel_bias_sigma = 0;
};

// The motion from one state to the next. The bias of the gyroscope is that of `motion`: poses tell
// it well, and what is not known of it is in `covariance`.
struct BundleMotionLink {
  int from = -1, to = -1;  // indices of states
  Preintegration motion;
  Matrix9d covariance;    // of its error, in the order of Preintegration::covariance
  double accel_walk = 0;  // standard deviation of the change of the accelerometer's bias, m/s²
};

struct BundleMotion {
  Se3 T_camera_imu;
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();  // in the world, m/s²
  std::vector<BundleMotionState> states;              // one per camera at most
  std::vector<BundleMotionLink> links;
};

}  // namespace alidade
