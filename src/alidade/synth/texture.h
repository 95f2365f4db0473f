// Textures with mip maps (Williams 1983), so that features are stable and do not alias when the
// camera moves.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace alidade {

class Texture {
 public:
  explicit Texture(const cv::Mat& grey);  // CV_8U, not empty

  int width() const { return levels_.front().width; }
  int height() const { return levels_.front().height; }

  // Gray level at (u, v) in [0, 1]², u to the right, v down; the border is replicated outside.
  // `lod`: log2 of the number of level-0 texels per pixel; trilinear interpolation.
  float Sample(float u, float v, float lod) const {
    const int last = static_cast<int>(levels_.size()) - 1;
    if (!(lod > 0)) return Bilinear(levels_[0], u, v);
    if (lod >= static_cast<float>(last)) return Bilinear(levels_[last], u, v);
    const int level = static_cast<int>(lod);
    const float share = lod - static_cast<float>(level);
    const float fine = Bilinear(levels_[level], u, v);
    return fine + share * (Bilinear(levels_[level + 1], u, v) - fine);
  }

 private:
  struct Level {
    int width, height;
    int stride;                 // texels per row; one texel of border on each side
    const unsigned char* data;  // first inner texel
  };
  static float Bilinear(const Level& level, float u, float v) {
    float x = u * static_cast<float>(level.width) - 0.5f,
          y = v * static_cast<float>(level.height) - 0.5f;
    x = x < -0.5f
            ? -0.5f
            : (x > static_cast<float>(level.width) - 0.5f ? static_cast<float>(level.width) - 0.5f
                                                          : x);
    y = y < -0.5f
            ? -0.5f
            : (y > static_cast<float>(level.height) - 0.5f ? static_cast<float>(level.height) - 0.5f
                                                           : y);
    const int ix = static_cast<int>(x + 1) - 1, iy = static_cast<int>(y + 1) - 1;  // floor, x >= -1
    const float fx = x - static_cast<float>(ix), fy = y - static_cast<float>(iy);
    const unsigned char* p = level.data + static_cast<ptrdiff_t>(iy) * level.stride + ix;
    const unsigned char* q = p + level.stride;
    const float top = p[0] + fx * static_cast<float>(p[1] - p[0]);
    const float bottom = q[0] + fx * static_cast<float>(q[1] - q[0]);
    return top + fy * (bottom - top);
  }

  std::vector<cv::Mat> images_;  // with borders; own the data of `levels_`
  std::vector<Level> levels_;
};

}  // namespace alidade
