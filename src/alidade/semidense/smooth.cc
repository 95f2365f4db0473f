#include "alidade/semidense/smooth.h"

#include <algorithm>
#include <cmath>

#include "alidade/base/parallel.h"
#include "alidade/semidense/fuse.h"

namespace alidade {
namespace {

constexpr int kEnoughAgree = 2;  // neighbors that must agree

// Known neighbors in the 3x3 window.
class Neighbours {
 public:
  Neighbours(const std::vector<int>& index, int width, std::span<const Hypothesis> depth,
             const EdgePixel& pixel) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (dx == 0 && dy == 0) continue;
        const int i = index[(pixel.y + dy) * width + pixel.x + dx];
        if (i >= 0 && depth[i].known()) around_[count_++] = depth[i];
      }
    }
  }
  // Mean of the compatible neighbors (and of `centre` if `itself`); unknown if there are too few.
  Hypothesis With(const Hypothesis& centre, bool itself, float chi2) const {
    int agree = 0;
    const float own = 1 / (centre.sigma * centre.sigma);
    float weight = itself ? own : 0, sum = itself ? own * centre.inverse_depth : 0;
    float sigma = itself ? centre.sigma : 1e30f;
    for (int k = 0; k < count_; ++k) {
      if (!Compatible(around_[k], centre, chi2)) continue;
      ++agree;
      const float w = 1 / (around_[k].sigma * around_[k].sigma);
      weight += w;
      sum += w * around_[k].inverse_depth;
      sigma = std::min(sigma, around_[k].sigma);
    }
    // Neighbors are correlated, so the mean is not more certain than the best of them.
    return agree < kEnoughAgree ? Hypothesis{} : Hypothesis{sum / weight, sigma};
  }
  Hypothesis Grown(float chi2) const {
    Hypothesis best;
    for (int k = 0; k < count_; ++k) {
      // A neighbor is compatible with itself, so it is included.
      const Hypothesis grown = With(around_[k], false, chi2);
      if (grown.known() && (!best.known() || grown.sigma < best.sigma)) best = grown;
    }
    return best;
  }

 private:
  Hypothesis around_[8];
  int count_ = 0;
};

}  // namespace

std::vector<Hypothesis> Smooth(std::span<const EdgePixel> edges, std::span<const Hypothesis> depth,
                               cv::Size size, float chi2) {
  std::vector<int> index(static_cast<size_t>(size.area()), -1);
  for (size_t i = 0; i < edges.size(); ++i) {
    index[edges[i].y * size.width + edges[i].x] = static_cast<int>(i);
  }
  constexpr int kChunk = 2048;  // pixels per task
  const int count = static_cast<int>(edges.size());
  const auto over = [&](auto&& body) {
    ParallelFor((count + kChunk - 1) / kChunk, [&](int chunk) {
      const int end = std::min(count, (chunk + 1) * kChunk);
      for (int i = chunk * kChunk; i < end; ++i) body(i);
    });
  };
  std::vector<Hypothesis> kept(edges.size());
  over([&](int i) {
    if (depth[i].known())
      kept[i] = Neighbours(index, size.width, depth, edges[i]).With(depth[i], true, chi2);
  });
  std::vector<Hypothesis> grown = kept;
  over([&](int i) {
    if (!kept[i].known()) grown[i] = Neighbours(index, size.width, kept, edges[i]).Grown(chi2);
  });
  return grown;
}

}  // namespace alidade
