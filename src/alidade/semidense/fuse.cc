#include "alidade/semidense/fuse.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "alidade/semidense/lanes.h"

namespace alidade {
namespace {

// The sets around four hypotheses at once, each the centre of one; lanes without a hypothesis are
// of unknown ones.
struct Sets {
  Floats centre, variance, chi2_variance;
  Ints count = All(0);
  Floats weight = All(0.0f), sum = All(0.0f);

  Sets(std::span<const Hypothesis> hypotheses, float chi2) {
    Lanes<float> depths{}, sigmas{};
    for (size_t lane = 0; lane < std::min<size_t>(kLanes, hypotheses.size()); ++lane) {
      depths[lane] = hypotheses[lane].inverse_depth;
      sigmas[lane] = hypotheses[lane].sigma;
    }
    const Floats sigma = cv::v_load(sigmas.data());
    centre = cv::v_load(depths.data());
    variance = sigma * sigma;
    chi2_variance = All(chi2) * variance;
  }
  // To each set whose centre it is compatible with. The sums are those of Compatible().
  void Add(const Hypothesis& other) {
    const float other_variance = other.sigma * other.sigma, w = 1 / other_variance;
    const Floats d = centre - All(other.inverse_depth), v = All(other_variance);
    const Floats member = d * d * (variance + v) < chi2_variance * v;
    count = count - cv::v_reinterpret_as_s32(member);  // a true lane is -1
    weight = weight + (member & All(w));
    sum = sum + (member & All(w * other.inverse_depth));
  }
};

}  // namespace

Hypothesis Fuse(std::span<const Hypothesis> hypotheses, float chi2, int enough) {
  const auto known = [](const Hypothesis& h) { return h.known(); };
  if (std::count_if(hypotheses.begin(), hypotheses.end(), known) < enough) return {};
  int most = enough - 1;
  float best_weight = 0;
  Hypothesis fused;
  for (size_t first = 0; first < hypotheses.size(); first += kLanes) {
    Sets sets(hypotheses.subspan(first), chi2);
    for (const Hypothesis& other : hypotheses) {
      if (other.known()) sets.Add(other);
    }
    Lanes<int> counts;
    Lanes<float> weights, sums;
    cv::v_store(counts.data(), sets.count);
    cv::v_store(weights.data(), sets.weight);
    cv::v_store(sums.data(), sets.sum);
    for (size_t lane = 0; lane < std::min<size_t>(kLanes, hypotheses.size() - first); ++lane) {
      if (!hypotheses[first + lane].known()) continue;
      const int count = counts[lane];
      const float weight = weights[lane];
      if (count < most || count < enough || (count == most && weight <= best_weight)) continue;
      most = count;
      best_weight = weight;
      fused = {sums[lane] / weight, 1 / std::sqrt(weight)};
    }
  }
  return fused;
}

}  // namespace alidade
