// What placed frames say of how long a rolling shutter takes to read an image.
#pragma once

#include <Eigen/Core>
#include <span>

#include "alidade/base/api.h"
#include "alidade/geometry/camera.h"
#include "alidade/geometry/se3.h"

namespace ALIDADE_API alidade {

// A landmark seen where it was looked for.
struct ReadoutMatch {
  Eigen::Vector3d p_camera;  // at the image's middle, map units
  Eigen::Vector2d residual;  // seen (the shutter undone) less expected, pixels
  Eigen::Vector2d raw;       // as in the image, pixels
  double weight = 1;         // 1 / variance, up to a factor that all have in common; 1/px²
};

// Sums over frames. With a = (seconds after the middle, per second of readout) × (velocity of the
// keypoint in the image) residuals are  e = a δ + B ξ + noise:  δ is by how much the readout is
// more than what the shutter was undone with, ξ the error of the frame's pose, which is eliminated.
// The map, which was made with the wrong readout, agrees with it in part: what is told is too
// little, but has the right sign.
class ReadoutSum {
 public:
  explicit ReadoutSum(const Camera& camera) : camera_(camera) {}
  // `motion`: what the frame's shutter was undone with (Frame::motion).
  void Add(const Vector6d& motion, std::span<const ReadoutMatch> matches);
  void Clear() { *this = ReadoutSum(camera_); }

  struct Told {
    double change = 0;  // seconds, along Camera::ReadAlong()
    double sigma = 0;  // by independent errors as large as the residuals; infinite: nothing is told
    double explained = 0;  // share of the residuals' squares that the change does away with
    int frames = 0;
  };
  Told told() const;

 private:
  Camera camera_;
  double H_ = 0, g_ = 0;  // px² / s² and px² / s, weighted
  double chi2_ = 0, measured_ = 0;
  int frames_ = 0;
};

}  // namespace alidade
