#include "alidade/semidense/keyframe_depth.h"

#include <algorithm>

#include "alidade/base/parallel.h"
#include "alidade/semidense/candidates.h"
#include "alidade/semidense/fuse.h"
#include "alidade/semidense/smooth.h"

namespace alidade {
namespace {

constexpr int kChunk = 2048;  // pixels per task

// Without fusion: the hypothesis with the smallest variance.
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
  const auto chi2 = static_cast<float>(settings.chi2_pair);
  const int chunks = static_cast<int>((pixels + kChunk - 1) / kChunk);
  std::vector<SearchCount> counts(chunks);
  ParallelFor(chunks, [&](int chunk) {
    const size_t begin = static_cast<size_t>(chunk) * kChunk;
    const size_t n = std::min<size_t>(kChunk, pixels - begin);
    std::vector<EpipolarSearch> searches;
    for (const EpipolarPair& pair : pairs) searches.emplace_back(pair, camera, settings);
    std::vector<Hypothesis> found(pairs.size());
    for (size_t i = begin; i < begin + n; ++i) {
      const DepthInterval whole = range.At(edges[i].x, edges[i].y);
      int known = 0;
      Candidates candidates(chi2);
      for (size_t k = 0; k < pairs.size(); ++k) {
        found[k] = {};
        // Skip if the remaining pairs cannot reach the required number.
        if (settings.fuse && known + static_cast<int>(pairs.size() - k) < settings.min_compatible)
          continue;
        found[k] = searches[k].Search(edges[i], candidates.Around(whole), counts[chunk]);
        candidates.Add(found[k]);
        known += found[k].known();
      }
      fused[i] = settings.fuse ? Fuse(found, chi2, settings.min_compatible) : MostCertain(found);
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
  return Smooth(edges, fused, size, chi2);
}

}  // namespace alidade
