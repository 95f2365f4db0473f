#include "alidade/semidense/keyframe_depth.h"

#include <algorithm>

#include "alidade/base/parallel.h"
#include "alidade/semidense/fuse.h"
#include "alidade/semidense/smooth.h"

namespace alidade {
namespace {

constexpr int kChunk = 2048;  // pixels of one body of a parallel loop

// Without fusion: what the best of them says.
Hypothesis MostCertain(std::span<const Hypothesis> hypotheses) {
  Hypothesis best;
  for (const Hypothesis& h : hypotheses) {
    if (h.known() && (!best.known() || h.sigma < best.sigma)) best = h;
  }
  return best;
}

}  // namespace

std::vector<Hypothesis> DepthFromMotion(const std::vector<EpipolarPair>& pairs,
                                        const Camera& camera, const DepthRange& range,
                                        const SemiDenseSettings& settings, SearchCount* count) {
  if (pairs.empty()) return {};
  const std::vector<EdgePixel>& edges = pairs.front().reference->edges;
  const size_t pixels = edges.size();
  std::vector<Hypothesis> fused(pixels);
  const int chunks = static_cast<int>((pixels + kChunk - 1) / kChunk);
  std::vector<SearchCount> counts(chunks);
  ParallelFor(chunks, [&](int chunk) {
    const size_t begin = static_cast<size_t>(chunk) * kChunk;
    const size_t n = std::min<size_t>(kChunk, pixels - begin);
    std::vector<Hypothesis> found(n * pairs.size());  // by pair, then pixel
    for (size_t k = 0; k < pairs.size(); ++k) {
      const SearchCount c = SearchEpipolarLines(pairs[k], camera, range, settings, begin,
                                                std::span(found).subspan(k * n, n));
      counts[chunk].searches += c.searches;
      counts[chunk].samples += c.samples;
    }
    std::vector<Hypothesis> of_pixel(pairs.size());
    for (size_t i = 0; i < n; ++i) {
      for (size_t k = 0; k < pairs.size(); ++k) of_pixel[k] = found[k * n + i];
      fused[begin + i] = settings.fuse ? Fuse(of_pixel, static_cast<float>(settings.chi2_pair),
                                              settings.min_compatible)
                                       : MostCertain(of_pixel);
    }
  });
  if (count) {
    for (const SearchCount& c : counts) {
      count->searches += c.searches;
      count->samples += c.samples;
    }
  }
  if (!settings.smooth) return fused;
  const cv::Size size(camera.width, camera.height);
  return Smooth(edges, fused, size, static_cast<float>(settings.chi2_pair));
}

}  // namespace alidade
