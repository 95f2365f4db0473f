// The way of a hand-held camera: a smooth closed curve, and the shake of hands and steps on top.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "alidade/geometry/se3.h"

namespace alidade {

// Where the camera is and looks. Yaw is about the vertical from the world's x axis, pitch is
// positive upwards.
struct PathKnot {
  Eigen::Vector3d position;   // metres
  double yaw = 0, pitch = 0;  // radians
};

struct ShakeSettings {
  double position = 0.012;  // metres, standard deviation along each axis
  double rotation = 0.02;   // radians, about each axis
  double seconds = 0.6;     // shortest period of the turning; hands are slower than 2 Hz or so
};

// How the way is gone along.
struct PathTiming {
  double speed = 1;  // times that of the knots; hands shake as ever
  // Seconds that are spent turning on the spot where the way begins, about the camera's centre and
  // back, before it is walked; it takes a second more to be at full speed.
  double turn_first = 0;
  double turn_angle = 1.2;  // radians, how far
};

// Uniform cubic B-spline through the neighbourhood of its knots (position and both angles have
// continuous accelerations), closed: after the last knot comes the first. `turns`: whole turns of
// yaw on the way round.
class CameraPath {
 public:
  CameraPath(std::vector<PathKnot> knots, double period, int turns, const ShakeSettings& shake,
             uint64_t seed, const PathTiming& timing = {});
  Se3 At(double time) const;  // T_world_camera; any time, seconds
  double period() const { return period_; }
  Eigen::Vector3d UnshakenPosition(double time) const;

 private:
  struct Wave {
    double amplitude, frequency, phase;  // radians per second, radians
  };
  PathKnot Spline(double time) const;
  double Shake(int axis, double time) const;
  double Walked(double time) const;  // seconds along the way

  std::vector<PathKnot> knots_;
  double period_;
  int turns_;
  PathTiming timing_;
  std::array<std::array<Wave, 6>, 6> waves_;  // 3 of position, 3 of rotation
};

// Rotation of a camera (x right, y down, z forward) that looks along yaw and pitch, z of the world
// up.
Eigen::Matrix3d LookAlong(double yaw, double pitch);

}  // namespace alidade
