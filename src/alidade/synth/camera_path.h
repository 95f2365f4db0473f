// Trajectory of a hand-held camera: a smooth closed curve plus the shake of hands and steps.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "alidade/geometry/se3.h"

namespace alidade {

// Camera position and viewing direction. Yaw is the angle from the world's x axis about the
// vertical; pitch is positive upwards.
struct PathKnot {
  Eigen::Vector3d position;   // meters
  double yaw = 0, pitch = 0;  // radians
};

struct ShakeSettings {
  double position = 0.012;  // metres, standard deviation along each axis
  double rotation = 0.02;   // radians, about each axis
  double seconds = 0.6;     // shortest period of the turning; hands are slower than 2 Hz or so
};

// Speed along the path.
struct PathTiming {
  double speed = 1;  // relative to that of the knots; the shake is not scaled
  // Seconds of pure rotation at the start of the path, to `turn_angle` and back, before the camera
  // moves; it reaches full speed one second later.
  double turn_first = 0;
  double turn_angle = 1.2;  // radians
};

// Pose of the camera and its exact derivatives by time.
struct PathMotion {
  Se3 T_world_camera;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();      // in the world, m/s
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  // in the world, without gravity, m/s²
  Eigen::Vector3d angular_rate = Eigen::Vector3d::Zero();  // in the camera's axes, rad/s
  Eigen::Vector3d angular_acceleration = Eigen::Vector3d::Zero();  // in the camera's axes, rad/s²
};

// Closed uniform cubic B-spline (continuous acceleration of position and angles) with the knots as
// control points. `turns`: full turns of yaw per period.
class CameraPath {
 public:
  CameraPath(std::vector<PathKnot> knots, double period, int turns, const ShakeSettings& shake,
             uint64_t seed, const PathTiming& timing = {});
  Se3 At(double time) const;  // T_world_camera at any time, seconds
  // The motion at the same time, from the derivatives of the spline, the shake and the timing.
  PathMotion MotionAt(double time) const;
  double period() const { return period_; }
  Eigen::Vector3d UnshakenPosition(double time) const;

 private:
  struct Wave {
    double amplitude, frequency, phase;  // radians per second, radians
  };
  // A value and its first two derivatives by time.
  struct Jet {
    double value, first, second;
  };
  std::array<PathKnot, 2> SplineDerivatives(double time) const;  // first and second, by `time`
  Jet ShakeJet(int axis, double time) const;
  Jet WalkedJet(double time) const;
  PathKnot Spline(double time) const;
  double Shake(int axis, double time) const;
  double Walked(double time) const;  // seconds along the path

  std::vector<PathKnot> knots_;
  double period_;
  int turns_;
  PathTiming timing_;
  std::array<std::array<Wave, 6>, 6> waves_;  // 3 of position, 3 of rotation
};

// Rotation R_world_camera of a camera (x right, y down, z forward) that looks along yaw and pitch;
// the world's z is up.
Eigen::Matrix3d LookAlong(double yaw, double pitch);

}  // namespace alidade
