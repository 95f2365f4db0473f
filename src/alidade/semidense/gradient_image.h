// Undistorted image of a keyframe with gradients, the input of semi-dense mapping.
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "alidade/features/picture.h"
#include "alidade/geometry/camera.h"

namespace alidade {

struct EdgePixel {
  uint16_t x = 0, y = 0;
};

struct GradientImage {
  // CV_8UC2: intensity, and gradient magnitude / √θ (so that both have equal weight in a residual),
  // saturated at 255.
  cv::Mat values;
  // CV_8U: gradient direction in steps of 1/kTurn of a full circle; kUnusable outside the lens's
  // field of view and on moving objects.
  cv::Mat direction;
  std::vector<EdgePixel> edges;  // pixels with gradient of at least λ_G, by row, then column
  std::vector<std::array<uint8_t, 3>> colors;  // one per edge: red, green, blue

  size_t bytes() const;
  // Reconstructs the picture as far as it is still known: gray, colors of edges, moving objects.
  Picture Straight() const;

  static constexpr int kTurn = 252;
  static constexpr uint8_t kUnusable = 255;
};

// Computes gradient images with undistortion, for one camera.
class GradientImageMaker {
 public:
  // `min_gradient` (λ_G): gray levels per pixel. `gradient_weight`: θ.
  GradientImageMaker(const Camera& camera, double min_gradient, double gradient_weight);
  // For pictures undistorted with `from`: undistorts them with `to` instead.
  GradientImageMaker(const Camera& from, const Camera& to, double min_gradient,
                     double gradient_weight);
  GradientImage Make(const Picture& picture) const;

 private:
  // `there` maps a pixel of the result to its position in the picture.
  template <typename Where>
  void MapFrom(const Camera& camera, Where&& there);

  double min_gradient_, gradient_scale_;
  cv::Mat map_x_, map_y_;  // for cv::remap; empty without distortion
  cv::Mat seen_;           // 255 inside the lens's field of view; empty: everywhere
};

}  // namespace alidade
