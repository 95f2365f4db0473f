// Camera model used throughout the library: pinhole with radial-tangential distortion, and the
// parameters of a depth source (second camera or depth image). Fisheye cameras and unrectified
// stereo pairs are converted to this model by rectify.h.
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
  double cx = 0, cy = 0;      // principal point, pixels; the center of the top-left pixel is (0, 0)
  std::array<double, 5> distortion{};  // k1 k2 p1 p2 k3 (Brown), unitless
  // Standard deviation of the focal lengths, relative, of a camera that was estimated or assumed;
  // 0: given, or not known.
  double focal_sigma = 0;
  double fps = 30;          // frames per second, used when there are no time stamps
  double depth_factor = 0;  // depth image value per meter; 0 = no depth image
  double baseline = 0;      // between left and right camera, meters; 0 = no second camera
  // Rolling-shutter readout time, seconds from the first to the last column (x) and row (y);
  // negative if read from last to first, 0 for a global shutter. A phone held upright reads its
  // images along x.
  std::array<double, 2> readout{};
  // False: `readout` is an initial guess to be estimated (tracking/readout.h).
  bool readout_known = false;
  // Index into `readout` of the likely readout direction if it is not calibrated: a sensor is read
  // line by line, and its lines lie along the longer side of the image.
  int ReadAlong() const { return width >= height ? 1 : 0; }

  void Check() const;  // throws Error (input) naming the invalid field
  bool HasDistortion() const;
  bool RollingShutter() const { return readout[0] != 0 || readout[1] != 0; }
  // Time at which a raw (distorted) pixel was read, seconds relative to the middle of the image.
  double ReadAfterMiddle(double raw_x, double raw_y) const {
    return readout[0] * ((raw_x + 0.5) / width - 0.5) + readout[1] * ((raw_y + 0.5) / height - 0.5);
  }

  // Undistorted pixel of a point in the camera frame. The caller must ensure z > 0.
  Eigen::Vector2d Project(const Eigen::Vector3d& p) const {
    return {fx * p.x() / p.z() + cx, fy * p.y() / p.z() + cy};
  }
  // Point in the camera frame at depth `z` that projects to an undistorted pixel.
  Eigen::Vector3d Unproject(const Eigen::Vector2d& pixel, double z = 1) const {
    return {(pixel.x() - cx) / fx * z, (pixel.y() - cy) / fy * z, z};
  }
  // Conversion between raw (distorted) pixels and those of the ideal pinhole.
  Eigen::Vector2d Distort(const Eigen::Vector2d& undistorted) const;
  // Newton's method; returns its argument if that diverges
  Eigen::Vector2d Undistort(const Eigen::Vector2d& distorted) const;

  // Focal length × baseline, pixels × meters: disparity = bf / depth.
  double bf() const { return fx * StereoBaseline(); }
  // Baseline of the second camera, meters. A depth sensor gets a virtual baseline of 0.08 m,
  // typical of structured-light cameras; it only sets how the depth error grows with depth²
  // relative to one pixel.
  double StereoBaseline() const { return baseline > 0 ? baseline : (depth_factor > 0 ? 0.08 : 0); }

  // The camera of the same image resized to another width. The height keeps the aspect ratio and is
  // rounded. Throws Error (usage) if `new_width` is not positive.
  Camera ScaledToWidth(int new_width) const;
  // Pinhole with square pixels: f = W / (2 tan(θ/2)) from the horizontal field of view θ, degrees.
  // Throws Error (usage) if θ is not in (0, 180).
  static Camera FromFieldOfView(int width, int height, double horizontal_fov_degrees);
};

}  // namespace alidade
