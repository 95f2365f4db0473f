#include "alidade/synth/sensor.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "alidade/base/parallel.h"

namespace alidade {
namespace {

uint64_t Mix(uint64_t x) {  // SplitMix64 (Steele et al. 2014)
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

// Standard normal values at the centers of 4096 intervals of equal probability: a random draw costs
// one look-up. The tails end at 3.7.
class GaussianTable {
 public:
  static constexpr int kSize = 4096;
  GaussianTable() {
    double low = -5;
    for (int i = 0; i < kSize; ++i) {
      const double share = (i + 0.5) / kSize;
      double a = low, b = 5;
      for (int step = 0; step < 40; ++step) {
        const double middle = (a + b) / 2;
        (0.5 * std::erfc(-middle / std::sqrt(2.0)) < share ? a : b) = middle;
      }
      low = a;
      values_[i] = static_cast<float>(a);
    }
  }
  float operator[](uint32_t index) const { return values_[index & (kSize - 1)]; }

 private:
  std::array<float, kSize> values_;
};

const GaussianTable& Gaussian() {
  static const GaussianTable table;
  return table;
}

// Fast random numbers for one row (xorshift64*, Vigna 2016). Rows are independent, so the result
// does not depend on threads.
class RowRandom {
 public:
  RowRandom(const NoiseKey& key, int row)
      : state_(Mix(Mix(key.seed * 0x10001 + static_cast<uint64_t>(key.channel)) +
                   (static_cast<uint64_t>(key.frame) << 20) + static_cast<uint64_t>(row)) |
               1) {}
  uint64_t Next() {
    state_ ^= state_ >> 12;
    state_ ^= state_ << 25;
    state_ ^= state_ >> 27;
    return state_ * 0x2545f4914f6cdd1dULL;
  }

 private:
  uint64_t state_;
};

}  // namespace

cv::Mat ExposeImage(const cv::Mat1f& clean, double gain, double bias, double sigma,
                    const NoiseKey& key) {
  const GaussianTable& gaussian = Gaussian();
  cv::Mat1b image(clean.size());
  const float scale = static_cast<float>(gain), s = static_cast<float>(sigma);
  const float offset = static_cast<float>(bias) + 0.5f;
  ParallelFor(clean.rows, [&](int y) {
    RowRandom random(key, y);
    const float* in = clean[y];
    unsigned char* out = image[y];
    uint64_t bits = 0;
    for (int x = 0; x < clean.cols; ++x) {
      bits = x % 5 == 0 ? random.Next() : bits >> 12;
      const float value = scale * in[x] + offset + s * gaussian[static_cast<uint32_t>(bits)];
      out[x] = static_cast<unsigned char>(value < 0 ? 0 : (value > 255 ? 255 : value));
    }
  });
  return image;
}

cv::Mat SenseDepth(const cv::Mat1f& exact, double focal, double factor, const NoiseKey& key,
                   const DepthSensorSettings& settings) {
  const GaussianTable& gaussian = Gaussian();
  cv::Mat1w depth(exact.size(), static_cast<uint16_t>(0));
  const float fb = static_cast<float>(focal * settings.baseline);
  const float step = static_cast<float>(settings.disparity_step),
              sigma = static_cast<float>(settings.disparity_sigma);
  const float edge = static_cast<float>(settings.edge_step),
              ragged = static_cast<float>(settings.lateral_sigma);
  const float nearest = static_cast<float>(settings.nearest),
              fading = static_cast<float>(settings.fading);
  const float farthest = static_cast<float>(settings.farthest);
  const int width = exact.cols, height = exact.rows;
  ParallelFor(height, [&](int y) {
    RowRandom random(key, y);
    // Going from right to left, the column x - fb / z in the projector's image decreases; where it
    // increases, the point is in the shadow of an object farther right.
    float lit = 1e9f;
    for (int x = width - 1; x >= 0; --x) {
      const uint64_t bits = random.Next();
      const float here = exact(y, x);
      if (!(here > 0)) continue;
      const float column = static_cast<float>(x) - fb / here;
      const bool shadow = column > lit + 1.0f;
      lit = std::min(lit, column);
      const int sx = std::clamp(
          x + static_cast<int>(ragged * gaussian[static_cast<uint32_t>(bits)] + 64.5f) - 64, 0,
          width - 1);
      const int sy = std::clamp(
          y + static_cast<int>(ragged * gaussian[static_cast<uint32_t>(bits >> 12)] + 64.5f) - 64,
          0, height - 1);
      const float z = exact(sy, sx);
      if (shadow || !(z >= nearest) || z >= farthest) continue;
      // The second difference distinguishes depth steps from slopes. Steep slopes reflect too
      // little light.
      const int left = std::max(0, sx - 1), right = std::min(width - 1, sx + 1);
      const int above = std::max(0, sy - 1), below = std::min(height - 1, sy + 1);
      const float bend_x = std::abs(exact(sy, left) + exact(sy, right) - 2 * z),
                  bend_y = std::abs(exact(above, sx) + exact(below, sx) - 2 * z);
      const float slope_x = std::abs(exact(sy, right) - exact(sy, left)),
                  slope_y = std::abs(exact(below, sx) - exact(above, sx));
      if (std::max(bend_x, bend_y) > edge * z || std::max(slope_x, slope_y) > 2 * edge * z)
        continue;
      float missing = 0.004f;
      if (z > fading) missing += 0.9f * (z - fading) / (farthest - fading);
      if (static_cast<float>((bits >> 24) & 0xffff) < 65536.0f * missing) continue;
      const float noisy = fb / z + sigma * gaussian[static_cast<uint32_t>(bits >> 40)];
      const float disparity = step * std::round(noisy / step);
      if (!(disparity > 0)) continue;
      const double value = static_cast<double>(fb / disparity) * factor + 0.5;
      depth(y, x) = value < 65535.0 ? static_cast<uint16_t>(value) : uint16_t{0};
    }
  });
  return depth;
}

}  // namespace alidade
