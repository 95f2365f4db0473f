#include "alidade/dynamics/feature_belief.h"

#include <algorithm>
#include <cmath>

#include "alidade/base/log_odds.h"

namespace alidade {
namespace {

// Log-odds of the surface with depth z near a cell. Of the nine cells around it, the one nearest to
// z with |z' - z| < surface × z is used. If none matches (a person seen behind a chair's back), the
// smallest log-odds of matching cells up to far_cells away is used; `otherwise` if there is none.
float OfSurface(const Cells& cells, const FrameBelief& belief, int cell, float z, float otherwise,
                const FeatureBeliefSettings& settings) {
  const float surface = settings.surface;
  const std::vector<float>& depth = belief.depth;
  float log_odds = otherwise, least = surface * z;
  cells.VisitAround(cell, 1, [&](int n) {
    if (!(depth[n] > 0) || std::abs(depth[n] - z) >= least) return;
    least = std::abs(depth[n] - z);
    log_odds = belief.log_odds[n];
  });
  if (least < surface * z) return log_odds;
  bool known = false;
  cells.VisitAround(cell, settings.far_cells, [&](int n) {
    if (!(depth[n] > 0) || std::abs(depth[n] - z) >= surface * z) return;
    log_odds = known ? std::min(log_odds, belief.log_odds[n]) : belief.log_odds[n];
    known = true;
  });
  return log_odds;
}

// Log-odds of the surface the keypoint is on. When its depth is unknown, the smallest log-odds
// around it, because a keypoint on an outline moves with the object.
float OfKeypoint(const Cells& cells, const FrameBelief& belief, const DepthImage& depth,
                 const Keypoint& keypoint, const FeatureBeliefSettings& settings) {
  const int cell = cells.At(keypoint.raw_x, keypoint.raw_y);
  const float here = belief.log_odds[cell];
  if (belief.depth.empty()) return here;
  float lowest = here;
  cells.VisitAround(cell, 1, [&](int n) { lowest = std::min(lowest, belief.log_odds[n]); });
  const float otherwise = lowest >= 0 ? here : lowest;
  const auto of_surface = [&](float z) {
    return OfSurface(cells, belief, cell, z, otherwise, settings);
  };
  if (keypoint.has_depth()) return of_surface(keypoint.depth);
  if (depth.size().empty()) return otherwise;
  const int x = static_cast<int>(std::lround(keypoint.raw_x));
  const int y = static_cast<int>(std::lround(keypoint.raw_y));
  const float reading = depth.At(x, y);
  if (reading > 0) return of_surface(reading);
  const int reach = settings.reading_reach;
  float worst = 0;
  bool known = false;
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const float z = depth.At(x + dx, y + dy);
      if (!(z > 0)) continue;
      const float of_it = of_surface(z);
      worst = known ? std::min(worst, of_it) : of_it;
      known = true;
    }
  }
  return known ? worst : otherwise;
}

// When too few features are certainly static, the uncertain ones not seen to move get a small
// weight, so that a pose can still be estimated.
void FeedTheStarving(const Cells& cells, const FrameBelief& belief,
                     std::span<const Keypoint> keypoints, const FeatureBeliefSettings& settings,
                     std::vector<float>& probabilities) {
  const auto certain = static_cast<float>(std::count_if(
      probabilities.begin(), probabilities.end(), [](float p) { return p >= Frame::kMappable; }));
  const auto all = static_cast<float>(keypoints.size());
  if (certain >= settings.enough_share * all && certain >= std::min(settings.enough_count, all / 2))
    return;
  for (size_t k = 0; k < keypoints.size(); ++k) {
    const int cell = cells.At(keypoints[k].raw_x, keypoints[k].raw_y);
    if (belief.geometry[cell] < 0) continue;  // seen to move
    probabilities[k] = std::max(probabilities[k], settings.uncertain_weight);
  }
}

}  // namespace

std::vector<float> StaticProbabilities(const Cells& cells, const FrameBelief& belief,
                                       const DepthImage& depth, std::span<const Keypoint> keypoints,
                                       const DynamicsSettings& settings) {
  std::vector<float> probabilities(keypoints.size());
  for (size_t k = 0; k < keypoints.size(); ++k) {
    float p = ProbabilityOf(OfKeypoint(cells, belief, depth, keypoints[k], settings.features));
    if (!settings.weigh) p = p >= Frame::kMappable ? 1.0f : 0.0f;
    probabilities[k] = p > settings.features.sure ? 1 : p;
  }
  if (settings.weigh) FeedTheStarving(cells, belief, keypoints, settings.features, probabilities);
  return probabilities;
}

}  // namespace alidade
