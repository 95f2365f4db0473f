#include "alidade/semidense/cross_check.h"

#include <algorithm>
#include <cmath>

#include "alidade/base/parallel.h"
#include "alidade/semidense/pixel_transfer.h"

namespace alidade {
namespace {

// Depth of another view, indexed by pixel, with the transfer to that view.
class Witness {
 public:
  Witness(const DepthView& view, const Camera& camera)
      : view_(view), width_(camera.width), height_(camera.height), index_(width_ * height_, -1) {
    for (size_t i = 0; i < view.edges.size(); ++i) {
      if (view.depth[i].known())
        index_[view.edges[i].y * width_ + view.edges[i].x] = static_cast<int>(i);
    }
    const PixelTransfer to_view(camera, view.T_view_reference);
    M_ = to_view.at_infinity;
    b_ = to_view.shift;
  }

  // Adds the compatible depths of the view at the four pixels around the projection to the normal
  // equation of the reference's inverse depth: residual r, derivative J and variance of each.
  // Returns false if there are none.
  bool Confirms(const EdgePixel& pixel, const Hypothesis& hypothesis, float chi2, float* jj,
                float* jr) const {
    const Eigen::Vector3f a = M_ * Eigen::Vector3f(pixel.x, pixel.y, 1);
    const Eigen::Vector3f h = a + hypothesis.inverse_depth * b_;
    if (h.z() < 0.05f) return false;
    const float x = h.x() / h.z(), y = h.y() / h.z();
    if (!(x >= 1 && y >= 1 && x < static_cast<float>(width_ - 2) &&
          y < static_cast<float>(height_ - 2)))
      return false;
    // Inverse depth in the view is rho / h.z (z' = h.z / rho); its derivative by rho is a.z / h.z².
    const float there = hypothesis.inverse_depth / h.z();
    const float derivative = a.z() / (h.z() * h.z());
    const float own = hypothesis.sigma * derivative;
    const int xi = static_cast<int>(x), yi = static_cast<int>(y);
    bool confirmed = false;
    for (int dy = 0; dy <= 1; ++dy) {
      for (int dx = 0; dx <= 1; ++dx) {
        const int i = index_[(yi + dy) * width_ + xi + dx];
        if (i < 0) continue;
        const Hypothesis& seen = view_.depth[i];
        const float sigma = seen.sigma;
        const float r = seen.inverse_depth - there;
        if (r * r > chi2 * (sigma * sigma + own * own)) continue;
        confirmed = true;
        const float w = 1 / (sigma * sigma);
        *jj += derivative * derivative * w;
        *jr += derivative * r * w;
      }
    }
    return confirmed;
  }

 private:
  const DepthView& view_;
  int width_, height_;
  std::vector<int> index_;
  Eigen::Matrix3f M_;
  Eigen::Vector3f b_;
};

}  // namespace

std::vector<Hypothesis> CrossCheck(std::span<const EdgePixel> edges,
                                   std::span<const Hypothesis> depth,
                                   std::span<const DepthView> views, const Camera& camera,
                                   const CrossCheckSettings& settings) {
  std::vector<Witness> witnesses;
  witnesses.reserve(views.size());
  for (const DepthView& view : views) witnesses.emplace_back(view, camera);
  std::vector<Hypothesis> checked(edges.size());
  constexpr int kChunk = 2048;  // pixels per task
  const int count = static_cast<int>(edges.size());
  ParallelFor((count + kChunk - 1) / kChunk, [&](int chunk) {
    const int end = std::min(count, (chunk + 1) * kChunk);
    for (int i = chunk * kChunk; i < end; ++i) {
      if (!depth[i].known()) continue;
      int confirmed = 0;
      const float own = 1 / (depth[i].sigma * depth[i].sigma);
      float jj = own, jr = 0;
      for (const Witness& witness : witnesses) {
        confirmed += witness.Confirms(edges[i], depth[i], settings.chi2, &jj, &jr);
      }
      if (confirmed < settings.enough) continue;
      checked[i] = {depth[i].inverse_depth + jr / jj, depth[i].sigma};
    }
  });
  return checked;
}

}  // namespace alidade
