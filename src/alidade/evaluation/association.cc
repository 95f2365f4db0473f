#include "alidade/evaluation/association.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "alidade/io/association.h"

namespace alidade {
namespace {

std::vector<StampPair> BestFirst(std::span<const double> truth, std::span<const double> estimate,
                                 double max_dt) {
  std::vector<StampPair> pairs;
  for (const auto& [t, e] : AssociateByTime(truth, estimate, max_dt)) pairs.push_back({t, e});
  return pairs;
}

std::vector<StampPair> NearestForShorter(std::span<const double> truth,
                                         std::span<const double> estimate, double max_dt) {
  const bool estimate_longer = estimate.size() > truth.size();
  const auto& shorter = estimate_longer ? truth : estimate;
  const auto& longer = estimate_longer ? estimate : truth;
  std::vector<StampPair> pairs;
  for (int i = 0; i < static_cast<int>(shorter.size()); ++i) {
    const int j = NearestStamp(longer, shorter[i]);
    if (std::abs(longer[j] - shorter[i]) > max_dt) continue;
    pairs.push_back(estimate_longer ? StampPair{i, j} : StampPair{j, i});
  }
  return pairs;
}

}  // namespace

std::vector<StampPair> AssociateStamps(std::span<const double> truth,
                                       std::span<const double> estimate, double max_dt,
                                       Association association) {
  if (truth.empty() || estimate.empty()) return {};
  std::vector<StampPair> pairs = association == Association::kTum
                                     ? BestFirst(truth, estimate, max_dt)
                                     : NearestForShorter(truth, estimate, max_dt);
  std::sort(pairs.begin(), pairs.end(), [](const StampPair& a, const StampPair& b) {
    return std::tie(a.estimate, a.truth) < std::tie(b.estimate, b.truth);
  });
  return pairs;
}

int NearestStamp(std::span<const double> stamps, double time) {
  const auto after = std::lower_bound(stamps.begin(), stamps.end(), time);
  if (after == stamps.begin()) return 0;
  if (after == stamps.end()) return static_cast<int>(stamps.size()) - 1;
  const auto before = after - 1;
  return static_cast<int>((time - *before <= *after - time ? before : after) - stamps.begin());
}

}  // namespace alidade
