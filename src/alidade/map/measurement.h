// Converts a keypoint to a measurement for the optimizers: pixel, right column, weights.
#pragma once

#include <Eigen/Core>
#include <limits>

#include "alidade/base/api.h"
#include "alidade/features/frame.h"
#include "alidade/geometry/camera.h"

namespace ALIDADE_API alidade {

// Measurement noise of a keypoint, pixels on level 0.
struct MeasurementNoise {
  double sigma_px = 0.8;  // of u and v; grows with the level's scale
  double sigma_right_px =
      0.4;  // of the disparity; a matched one grows with the scale, a depth sensor's does not
  bool right_from_sensor = false;
  // Of a depth camera: sigma_z = sensor_noise z². 0.003 / m is a Kinect (1 cm at 2 m: Khoshelham &
  // Elberink 2012 measured 0.0014 to 0.003); how far it sees at all is tracker.depth_range.
  double sensor_noise = 0.003;
};

struct Measurement {
  Eigen::Vector3d pixel;                        // u, v, and right column (u - disparity) or NaN
  double inv_sigma2 = 1, inv_sigma2_right = 1;  // 1/px²
};

inline Measurement Measure(const Keypoint& keypoint, const MeasurementNoise& noise) {
  const double scale = ScaleOfLevel(keypoint.level);
  const double sigma = noise.sigma_px * scale;
  const double right = noise.sigma_right_px * (noise.right_from_sensor ? 1.0 : scale);
  return {{keypoint.x, keypoint.y,
           keypoint.has_depth() ? keypoint.right_x : std::numeric_limits<double>::quiet_NaN()},
          1 / (sigma * sigma),
          1 / (right * right)};
}

// Relative standard deviation sigma_z / z of a keypoint's depth. Stereo: z = f b / d, hence sigma_z
// = z² sigma_d / (f b). Depth camera: sigma_z = sensor_noise z².
inline double DepthErrorShare(const Keypoint& keypoint, const Camera& camera,
                              const MeasurementNoise& noise) {
  if (noise.right_from_sensor) return noise.sensor_noise * keypoint.depth;
  return keypoint.depth * noise.sigma_right_px * ScaleOfLevel(keypoint.level) / camera.bf();
}

}  // namespace alidade
