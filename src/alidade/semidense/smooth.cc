#include "alidade/semidense/smooth.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "alidade/base/parallel.h"
#include "alidade/semidense/fuse.h"
#include "alidade/semidense/pixel_index.h"

namespace alidade {
namespace {

constexpr int kEnoughAgree = 2;  // neighbors that must agree

// Known neighbors in the 3x3 window.
class Neighbours {
 public:
  // `itself`: index of `pixel`.
  Neighbours(const PixelIndex& index, std::span<const Hypothesis> depth, const EdgePixel& pixel,
             size_t itself) {
    for (int dy = -1; dy <= 1; ++dy) {
      auto [bits, i] = index.At(pixel.x - 1u, pixel.y + dy, 3);
      for (; bits != 0; bits &= bits - 1, ++i) {
        if (i != itself && depth[i].known()) Add(depth[i]);
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
      weight += weights_[k];
      sum += weights_[k] * around_[k].inverse_depth;
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
  void Add(const Hypothesis& h) {
    around_[count_] = h;
    weights_[count_++] = 1 / (h.sigma * h.sigma);
  }

  std::array<Hypothesis, 8> around_;
  std::array<float, 8> weights_;
  int count_ = 0;
};

}  // namespace

std::vector<Hypothesis> Smooth(std::span<const EdgePixel> edges, std::span<const Hypothesis> depth,
                               cv::Size size, float chi2) {
  PixelIndex index(size.width, size.height);
  for (const EdgePixel& edge : edges) index.Append(edge);
  index.Finish();
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
      kept[i] = Neighbours(index, depth, edges[i], i).With(depth[i], true, chi2);
  });
  std::vector<Hypothesis> grown = kept;
  over([&](int i) {
    if (!kept[i].known()) grown[i] = Neighbours(index, kept, edges[i], i).Grown(chi2);
  });
  return grown;
}

}  // namespace alidade
