// Attitude of a camera with respect to gravity by a gyroscope, an accelerometer and rotations
// between images: what is known of the orientation while there is no map.
//
// An extended Kalman filter with errors on the left, R = Exp(error) R_estimate, in a world whose z
// axis is up. In these all attitudes change alike with the heading of the world, which nothing
// measures, so that linearization gives the heading no information (Barrau & Bonnabel 2017).
//
// The acceleration of a held camera is no white noise: its velocity remains small. It is modeled as
// dv = -v/τ dt + dw with a stationary standard deviation σ (an Ornstein-Uhlenbeck process). Since
// the accelerometer tells dv, this is a measurement of every moment: R f + g + v/τ = dw/dt, white
// with the density 2 σ²/τ. Over T seconds gravity is so known to about σ / (9.81 T).
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "alidade/inertial/imu.h"
#include "alidade/inertial/inertial_fit.h"
#include "alidade/inertial/preintegration.h"

namespace ALIDADE_API alidade {

// An orientation of the camera. The world's z axis is up, and its x axis is the horizontal
// direction in which the camera looked at the start (where it looked down or up: in which the upper
// or the lower edge of its image was).
struct Attitude {
  Eigen::Matrix3d R_world_camera = Eigen::Matrix3d::Identity();
  // Of the rotation vector e with R_true = Exp(e) R, in the axes of the world, rad².
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();

  double TiltSigma() const;     // of the vertical, along its less known direction, radians
  double HeadingSigma() const;  // of the angle about the vertical since the start, radians
};

// What is believed before.
struct AttitudePriors {
  ImuBias bias;
  double gyro_bias = 0.1;     // rad/s: InertialPriors
  double accel_bias = 0.3;    // m/s²
  double rotation = 3e-3;     // of model.T_camera_imu.R, radians, each axis
  double time_offset = 1e-3;  // seconds
  double held_speed = 1;      // m/s, σ of the velocity: a person who walks
  double held_seconds = 3;    // τ of the velocity: indoors a walk changes its direction
};

class AttitudeFilter {
 public:
  // Begins at the image of `image_time` (seconds). The tilt is that of `samples` (not empty) about
  // that time. `R_start_camera`: rotation of the camera since the start, whose heading is 0.
  AttitudeFilter(const ImuModel& model, const AttitudePriors& priors, double image_time,
                 std::span<const ImuSample> samples, const Eigen::Matrix3d& R_start_camera);

  // Carries the state to the image of `image_time`, not before the present one, by readings in
  // order of time. What they do not cover is extrapolated; of a gap of more than 0.1 s it is
  // assumed that the camera turns by 1 rad/s.
  void Advance(double image_time, std::span<const ImuSample> samples);

  // A view is a direction that was seen before, or a map: anything whose rotation to the camera is
  // measured again and again. Its own attitude becomes part of the state: that of the present
  // camera, turned by R_camera_view, which is known with a covariance (camera axes, rad²).
  void AddView(int id, const Eigen::Matrix3d& R_camera_view,
               const Eigen::Matrix3d& covariance = Eigen::Matrix3d::Zero());
  void DropView(int id);
  bool HasView(int id) const;
  // The measured rotation of the present camera to a view: R_view_camera Exp(e) is true, with e of
  // that covariance, rad². False: it contradicts the state (chi², 99.9 %), and is not used.
  bool See(int id, const Eigen::Matrix3d& R_view_camera, const Eigen::Matrix3d& covariance);

  // The camera is at a spot, from which it may turn away and come back: the images show no more
  // motion than `sigma` (meters, standard deviation) since the last MoveOn().
  void StayAtSpot(double sigma);
  void MoveOn();  // to another spot

  Attitude Camera() const;
  Attitude View(int id) const;  // of the view, which is there
  ImuBias bias() const { return bias_; }
  // With the rotation and the clock as they are known now, and their standard deviations, radians
  // (the largest axis) and seconds.
  const ImuModel& model() const { return model_; }
  double RotationSigma() const;
  double TimeOffsetSigma() const;

 private:
  // Order of the errors. kMounting: of R_camera_imu Exp(error).
  enum : int {
    kAttitude = 0,
    kGyro = 3,
    kAccel = 6,
    kVelocity = 9,
    kPosition = 12,
    kMounting = 15,
    kClock = 18,
    kViews = 19  // 3 of each view; the first one is the camera at the start
  };
  struct SeenView {
    int id;
    Eigen::Matrix3d R_world_view;
  };
  using Rows3 = Eigen::Matrix<double, 3, Eigen::Dynamic>;
  int IndexOf(int id) const;  // in views_; -1: not there
  Eigen::Matrix3d R_world_camera() const;
  Rows3 ByCamera() const;  // derivative of the camera's error by the state's
  Eigen::Vector3d StartAhead() const;
  Attitude Told(const Eigen::Matrix3d& R, const Rows3& by_state) const;
  void Step(const ImuSample& from, const ImuSample& to);
  void Gap(double seconds);
  void MeasureMotion(double seconds, const Eigen::Vector3d& force);
  bool Measure(const Rows3& by_state, const Eigen::Vector3d& residual, const Eigen::Matrix3d& noise,
               double gate);
  void Increase(const Eigen::VectorXd& step);

  ImuModel model_;
  AttitudePriors priors_;
  double time_ = 0;  // on the clock of the readings
  Eigen::Matrix3d R_world_imu_ = Eigen::Matrix3d::Identity();
  ImuBias bias_;
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();      // in the world, m/s
  Eigen::Vector3d position_ = Eigen::Vector3d::Zero();      // from the spot, in the world, m
  Eigen::Vector3d angular_rate_ = Eigen::Vector3d::Zero();  // the last reading, bias not subtracted
  std::vector<SeenView> views_;
  Eigen::MatrixXd covariance_;
};

}  // namespace alidade
