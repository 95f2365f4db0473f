// The camera as the rest of the program sees it: a pinhole with radial-tangential distortion, and
// what measures depth beside it (a second camera, or a depth image). Fisheye and unrectified stereo
// pairs are turned into this by rectify.h before they get here.
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>

#include "alidade/base/api.h"
#include "alidade/geometry/se3.h"

namespace ALIDADE_API alidade {

struct Camera {
  int width = 0, height = 0;  // pixels
  double fx = 0, fy = 0;      // focal lengths, pixels
  double cx = 0, cy = 0;      // principal point, pixels; the centre of the top-left pixel is 0, 0
  std::array<double, 5> distortion{};  // k1 k2 p1 p2 k3 (Brown), unitless
  double fps = 30;                     // frames per second, where time stamps don't say
  double depth_factor = 0;             // depth image value per metre; 0 = no depth image
  double baseline = 0;                 // metres between left and right camera; 0 = no second camera
  // Rolling shutter: seconds that pass from the first to the last column (x) and row (y) of the
  // image as it is read; negative from the last to the first, 0 0 all at once. A picture taken
  // upright by a phone is read along x.
  std::array<double, 2> readout{};
  bool readout_known = false;  // else readout is a guess, to be found (tracking/readout.h)
  // Which of `readout` a sensor has, where nobody says: it is read line by line, and its lines lie
  // along the longer side.
  int ReadAlong() const { return width >= height ? 1 : 0; }

  void Check() const;  // throws Error (input) naming the field that cannot be
  bool HasDistortion() const;
  bool RollingShutter() const { return readout[0] != 0 || readout[1] != 0; }
  // When a pixel of the image as taken was read, in seconds after the image's middle.
  double ReadAfterMiddle(double raw_x, double raw_y) const {
    return readout[0] * ((raw_x + 0.5) / width - 0.5) + readout[1] * ((raw_y + 0.5) / height - 0.5);
  }

  // Undistorted pixel of a point in the camera frame (z > 0 is the caller's to see to).
  Eigen::Vector2d Project(const Eigen::Vector3d& p) const {
    return {fx * p.x() / p.z() + cx, fy * p.y() / p.z() + cy};
  }
  // Point at depth z seen at an undistorted pixel.
  Eigen::Vector3d Unproject(const Eigen::Vector2d& pixel, double z = 1) const {
    return {(pixel.x() - cx) / fx * z, (pixel.y() - cy) / fy * z, z};
  }
  // Between pixels of the image as taken and of an ideal pinhole.
  Eigen::Vector2d Distort(const Eigen::Vector2d& undistorted) const;
  Eigen::Vector2d Undistort(const Eigen::Vector2d& distorted) const;  // by Newton's method

  // Focal length × baseline: disparity = bf / z. RGB-D gets a virtual baseline (see
  // StereoBaseline()).
  double bf() const { return fx * StereoBaseline(); }
  // The second camera's, or for a depth sensor 0.08 m (structured-light cameras have about that):
  // it only says how a depth error grows with z² against a pixel.
  double StereoBaseline() const { return baseline > 0 ? baseline : (depth_factor > 0 ? 0.08 : 0); }

  // The camera of the same view, its image resized to another width (height keeps the aspect ratio,
  // rounded).
  Camera ScaledToWidth(int new_width) const;
  // Pinhole from the horizontal field of view (degrees): f = W / (2 tan(θ/2)); square pixels.
  static Camera FromFieldOfView(int width, int height, double horizontal_fov_degrees);
};

}  // namespace alidade
