#include "alidade/semidense/cross_check.h"

#include <algorithm>
#include <cmath>

#include "alidade/base/parallel.h"
#include "alidade/semidense/lanes.h"
#include "alidade/semidense/pixel_index.h"
#include "alidade/semidense/pixel_transfer.h"

namespace alidade {
namespace {

// Pixels of the reference and their depth, with the normal equation of each inverse depth: sums of
// J² / σ² and J r / σ², J being the derivative and r the residual of what a view has seen.
struct Checks {
  std::vector<float> x, y, inverse_depth, sigma, jj, jr;
  std::vector<int> confirmed;  // views

  // Room for some more, so that whole vectors can be read.
  explicit Checks(size_t count) : confirmed(count) {
    for (auto* values : {&x, &y, &inverse_depth, &sigma, &jj, &jr}) values->resize(count + kLanes);
  }
};

// Depth of another view, indexed by pixel, with the transfer to that view.
class Witness {
 public:
  Witness(const DepthView& view, const Camera& camera)
      : width_(camera.width),
        height_(camera.height),
        to_view_(camera, view.T_view_reference),
        index_(width_, height_) {
    known_.reserve(view.edges.size());
    for (size_t i = 0; i < view.edges.size(); ++i) {
      if (!view.depth[i].known()) continue;
      index_.Append(view.edges[i]);
      known_.push_back(view.depth[i]);
    }
    index_.Finish();
  }

  void Check(float chi2, Checks& checks) const {
    const int count = static_cast<int>(checks.confirmed.size());
    for (int first = 0; first < count; first += kLanes) {
      const Projections seen = Project(checks, first);
      for (int lane = 0; lane < std::min(kLanes, count - first); ++lane) {
        if (seen.inside >> lane & 1) Confirm(seen, lane, chi2, first + lane, checks);
      }
    }
  }

 private:
  struct Projections {
    Lanes<int> x, y;
    // Inverse depth in the view is rho / h.z (z' = h.z / rho); its derivative by rho is a.z / h.z².
    // `variance`: of the inverse depth in the view.
    Lanes<float> there, derivative, variance;
    int inside;  // bit per lane: in the image and in front of the camera
  };

  Projections Project(const Checks& checks, int first) const {
    const auto at = [&](const std::vector<float>& values) { return cv::v_load(&values[first]); };
    const Floats x = at(checks.x), y = at(checks.y), rho = at(checks.inverse_depth);
    const Eigen::Matrix3f& M = to_view_.at_infinity;
    const auto far = [&](int i) { return All(M(i, 0)) * x + (All(M(i, 1)) * y + All(M(i, 2))); };
    const auto moved = [&](const Floats& a, int i) { return a + rho * All(to_view_.shift[i]); };
    const Floats a_z = far(2), z = moved(a_z, 2);
    const Floats u = moved(far(0), 0) / z, v = moved(far(1), 1) / z, one = All(1.0f);
    const Floats derivative = a_z / (z * z), own = at(checks.sigma) * derivative;
    Projections result;
    result.inside = cv::v_signmask((z >= All(0.05f)) & (u >= one) & (v >= one) &
                                   (u < All(static_cast<float>(width_ - 2))) &
                                   (v < All(static_cast<float>(height_ - 2))));
    cv::v_store(result.x.data(), cv::v_trunc(u));
    cv::v_store(result.y.data(), cv::v_trunc(v));
    cv::v_store(result.there.data(), rho / z);
    cv::v_store(result.derivative.data(), derivative);
    cv::v_store(result.variance.data(), own * own);
    return result;
  }

  // Adds the compatible depths of the view at the four pixels around the projection.
  void Confirm(const Projections& at, int lane, float chi2, int i, Checks& checks) const {
    const float there = at.there[lane], own = at.variance[lane], derivative = at.derivative[lane];
    float jj = checks.jj[i], jr = checks.jr[i];
    bool confirmed = false;
    for (int dy = 0; dy <= 1; ++dy) {
      auto [bits, found] = index_.At(at.x[lane], at.y[lane] + dy, 2);
      for (; bits != 0; bits &= bits - 1, ++found) {
        const Hypothesis& seen = known_[found];
        const float variance = seen.sigma * seen.sigma;
        const float r = seen.inverse_depth - there;
        if (r * r > chi2 * (variance + own)) continue;
        confirmed = true;
        const float w = 1 / variance;
        jj += derivative * derivative * w;
        jr += derivative * r * w;
      }
    }
    checks.jj[i] = jj;
    checks.jr[i] = jr;
    checks.confirmed[i] += confirmed;
  }

  int width_, height_;
  PixelTransfer to_view_;
  PixelIndex index_;
  std::vector<Hypothesis> known_;  // in the order of index_
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
    std::vector<int> indices;  // of pixels with depth
    for (int i = chunk * kChunk; i < end; ++i) {
      if (depth[i].known()) indices.push_back(i);
    }
    Checks checks(indices.size());
    for (size_t k = 0; k < indices.size(); ++k) {
      const Hypothesis& h = depth[indices[k]];
      checks.x[k] = edges[indices[k]].x;
      checks.y[k] = edges[indices[k]].y;
      checks.inverse_depth[k] = h.inverse_depth;
      checks.sigma[k] = h.sigma;
      checks.jj[k] = 1 / (h.sigma * h.sigma);
    }
    for (const Witness& witness : witnesses) witness.Check(settings.chi2, checks);
    for (size_t k = 0; k < indices.size(); ++k) {
      const float shift = checks.jr[k] / checks.jj[k];
      if (checks.confirmed[k] >= settings.enough)
        checked[indices[k]] = {checks.inverse_depth[k] + shift, checks.sigma[k]};
    }
  });
  return checked;
}

}  // namespace alidade
