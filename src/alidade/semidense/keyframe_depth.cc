#include "alidade/semidense/keyframe_depth.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>

#include "alidade/base/parallel.h"
#include "alidade/semidense/candidates.h"
#include "alidade/semidense/fuse.h"
#include "alidade/semidense/smooth.h"

namespace alidade {
namespace {

constexpr int kChunk = 2048;  // pixels per task
constexpr int kBlock = 256;   // pixels searched in one partner after the other

// Without fusion: the hypothesis with the smallest variance.
Hypothesis MostCertain(std::span<const Hypothesis> hypotheses) {
  Hypothesis best;
  for (const Hypothesis& h : hypotheses) {
    if (h.known() && (!best.known() || h.sigma < best.sigma)) best = h;
  }
  return best;
}

// Searches the pixels in all partners: one hypothesis per pixel and partner, pixel by pixel.
std::vector<Hypothesis> SearchAll(std::vector<EpipolarSearch>& searches,
                                  std::span<const EdgePixel> pixels, const DepthRange& range,
                                  const SemiDenseSettings& settings, SearchCount& count) {
  const size_t partners = searches.size();
  std::vector<Hypothesis> found(pixels.size() * partners);
  std::vector<Candidates> candidates(pixels.size(),
                                     Candidates(static_cast<float>(settings.chi2_pair)));
  std::vector<size_t> open(pixels.size());
  std::iota(open.begin(), open.end(), size_t{0});
  for (size_t partner = 0; partner < partners; ++partner) {
    // A pixel is left out once the remaining partners cannot give it the required number.
    const int missing = settings.min_compatible - static_cast<int>(partners - partner);
    if (settings.fuse)
      std::erase_if(open, [&](size_t i) { return candidates[i].known() < missing; });
    const auto lanes = static_cast<size_t>(searches[partner].lanes());
    for (size_t i = 0; i < open.size(); i += lanes) {
      const size_t n = std::min(lanes, open.size() - i);
      std::array<EpipolarQuery, kMostLanes> queries;
      std::array<Hypothesis, kMostLanes> result;
      for (size_t k = 0; k < n; ++k) {
        const EdgePixel& pixel = pixels[open[i + k]];
        queries[k] = {pixel, candidates[open[i + k]].Around(range.At(pixel.x, pixel.y))};
      }
      searches[partner].Search({queries.data(), n}, result, count);
      for (size_t k = 0; k < n; ++k) {
        found[open[i + k] * partners + partner] = result[k];
        candidates[open[i + k]].Add(result[k]);
      }
    }
  }
  return found;
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
    const size_t end = std::min<size_t>(begin + kChunk, pixels);
    std::vector<EpipolarSearch> searches;
    for (const EpipolarPair& pair : pairs) searches.emplace_back(pair, camera, settings);
    for (size_t i = begin; i < end; i += kBlock) {
      const std::span<const EdgePixel> block(edges.data() + i, std::min<size_t>(kBlock, end - i));
      const std::vector<Hypothesis> found =
          SearchAll(searches, block, range, settings, counts[chunk]);
      for (size_t k = 0; k < block.size(); ++k) {
        const std::span<const Hypothesis> of_pixel(found.data() + k * pairs.size(), pairs.size());
        fused[i + k] =
            settings.fuse ? Fuse(of_pixel, chi2, settings.min_compatible) : MostCertain(of_pixel);
      }
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
