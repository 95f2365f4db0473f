// A keyframe's picture as semi-dense mapping sees it: undistorted, with gradients.
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
  // CV_8UC2: intensity, and gradient magnitude over √θ (both then weigh the same in a residual);
  // 255 when it is that or more.
  cv::Mat values;
  // CV_8U: direction of the gradient in steps of 1/kTurn of a turn, kUnusable outside the lens'
  // view and on what moves.
  cv::Mat direction;
  std::vector<EdgePixel> edges;  // pixels with gradient of λ_G or more, by row, then column
  std::vector<std::array<uint8_t, 3>> colors;  // one for each: red green blue

  size_t bytes() const;
  // The picture it was made of, as far as it is still known: grey, colours of edges, what moves.
  Picture Straight() const;

  static constexpr int kTurn = 252;
  static constexpr uint8_t kUnusable = 255;
};

// Takes lens distortion out of pictures, again and again for one camera.
class GradientImageMaker {
 public:
  // `min_gradient` (λ_G): grey levels per pixel; `gradient_weight`: θ.
  GradientImageMaker(const Camera& camera, double min_gradient, double gradient_weight);
  // For pictures of which the distortion of `from` was taken out, to have that of `to` out instead.
  GradientImageMaker(const Camera& from, const Camera& to, double min_gradient,
                     double gradient_weight);
  GradientImage Make(const Picture& picture) const;

 private:
  // `there`: where in the picture a pixel of the result lies.
  template <typename Where>
  void MapFrom(const Camera& camera, Where&& there);

  double min_gradient_, gradient_scale_;
  cv::Mat map_x_, map_y_;  // for cv::remap; empty without distortion
  cv::Mat seen_;           // 255 where the lens sees; empty: everywhere
};

}  // namespace alidade
