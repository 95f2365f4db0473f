// Sensor models: noisy gray levels, and depth of a structured-light camera.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace alidade {

// Key of a noise stream: equal keys give equal noise.
struct NoiseKey {
  uint64_t seed = 1;
  int frame = 0;
  int channel = 0;
};

// CV_8U: gain * clean + bias plus Gaussian noise of standard deviation `sigma` (gray levels),
// clamped to [0, 255].
cv::Mat ExposeImage(const cv::Mat1f& clean, double gain, double bias, double sigma,
                    const NoiseKey& key);

struct DepthSensorSettings {
  double baseline = 0.075;  // metres between projector and camera (Kinect)
  double disparity_step =
      0.125;  // pixels: disparity is measured in eighths (Khoshelham & Elberink 2012)
  double disparity_sigma = 0.11;      // pixels: at 2 m about 1.1 cm with the step, growing with z²
  double lateral_sigma = 0.6;         // pixels: edges are ragged
  double nearest = 0.4;               // metres; nothing is measured below
  double fading = 4.5, farthest = 7;  // metres; more and more is missing in between
  double edge_step =
      0.05;  // relative depth step between neighbours beyond which there is no reading
};

// CV_16U, `factor` per meter, 0 = no reading. Models disparity noise and quantization, ragged and
// missing depth at edges, the shadow of the projector (to the right of the camera) beside
// foreground objects, and holes at grazing angles and out of range. `focal`: pixels.
cv::Mat SenseDepth(const cv::Mat1f& exact, double focal, double factor, const NoiseKey& key,
                   const DepthSensorSettings& settings = {});

}  // namespace alidade
