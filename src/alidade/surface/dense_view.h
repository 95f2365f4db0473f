// Dense depth seen from one place: what meshes and grids are made of.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "alidade/geometry/camera.h"
#include "alidade/geometry/se3.h"

namespace alidade {

struct DenseView {
  Camera camera;  // of `depth`: a pinhole without distortion
  Se3 T_world_camera;
  cv::Mat1f depth;  // meters (map units) along z; 0: unknown
  cv::Mat3b color;  // blue green red, of the size of `depth`; empty: unknown
  // Standard deviation of inverse depth, 1/m. Depth from disparity, be it of stereo or of
  // structured light, has the same at all distances: sigma_z = z² · inverse_sigma.
  double inverse_sigma = 0;
  // The same for each pixel, of the size of `depth`; empty: `inverse_sigma` is that of all.
  cv::Mat1f inverse_sigmas;

  double InverseSigmaAt(int x, int y) const {
    return inverse_sigmas.empty() ? inverse_sigma : inverse_sigmas(y, x);
  }
};

// Depth cameras: 3 mm at 1 m, 1.2 cm at 2 m, which is 0.1 pixels of disparity with a baseline of 5
// to 8 cm. A calibrated Kinect has half of it (Khoshelham & Elberink 2012); the rest is
// registration.
inline constexpr double kSensorInverseSigma = 0.003;

// Depth whose standard deviation is `sigma`, meters; infinite without noise.
double RangeAt(double inverse_sigma, double sigma);

// Without the readings beside a step in depth, which lie between both surfaces or belong to the
// wrong one: those with a neighbor (3 x 3) whose depth differs by more than 5 %.
cv::Mat1f WithoutSteps(const cv::Mat1f& depth);

}  // namespace alidade
