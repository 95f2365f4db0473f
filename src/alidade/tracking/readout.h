// Estimates the rolling-shutter readout time from tracked frames.
#pragma once

#include <Eigen/Core>
#include <span>

#include "alidade/base/api.h"
#include "alidade/geometry/camera.h"
#include "alidade/geometry/se3.h"

namespace ALIDADE_API alidade {

// Observation of a landmark at its predicted position.
struct ReadoutMatch {
  Eigen::Vector3d p_camera;  // at the middle of the image, map units
  Eigen::Vector2d residual;  // observed (rolling shutter corrected) minus predicted, pixels
  Eigen::Vector2d raw;       // raw position in the image, pixels
  double weight = 1;         // 1 / variance up to a common factor, 1/px²
};

// Accumulates normal equations over frames. With a = (readout position relative to the middle,
// seconds per second of readout) × (velocity of the keypoint in the image), the residuals are e = a
// δ + B ξ + noise: δ is the error of the assumed readout time, ξ the error of the frame's pose,
// which is eliminated. A map built with the wrong readout time partly agrees with it, so the
// estimate is too small but has the right sign.
class ReadoutSum {
 public:
  explicit ReadoutSum(const Camera& camera) : camera_(camera) {}
  // `motion`: with which the frame's rolling shutter was corrected (Frame::motion).
  void Add(const Vector6d& motion, std::span<const ReadoutMatch> matches);
  void Clear() { *this = ReadoutSum(camera_); }

  struct Told {
    double change = 0;  // of the readout time, seconds, along Camera::ReadAlong()
    // For independent errors of the size of the residuals; infinite: not observable.
    double sigma = 0;
    // Share of the sum of squared residuals that the change removes.
    double explained = 0;
    int frames = 0;
  };
  Told told() const;

 private:
  Camera camera_;
  double H_ = 0, g_ = 0;  // weighted, px² / s² and px² / s
  double chi2_ = 0, measured_ = 0;
  int frames_ = 0;
};

}  // namespace alidade
