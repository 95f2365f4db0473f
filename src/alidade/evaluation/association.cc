#include "alidade/evaluation/association.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace alidade {
namespace {

std::vector<StampPair> BestFirst(std::span<const double> truth, std::span<const double> estimate,
                                 double max_dt) {
  struct Candidate {
    double difference;
    int truth, estimate;
  };
  std::vector<Candidate> candidates;
  for (int e = 0; e < static_cast<int>(estimate.size()); ++e) {
    const auto first = std::lower_bound(truth.begin(), truth.end(), estimate[e] - max_dt);
    for (int t = static_cast<int>(first - truth.begin()); t < static_cast<int>(truth.size()); ++t) {
      if (truth[t] > estimate[e] + max_dt) break;
      const double difference = std::abs(truth[t] - estimate[e]);
      if (difference < max_dt) candidates.push_back({difference, t, e});
    }
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(a.difference, a.truth, a.estimate) <
           std::tie(b.difference, b.truth, b.estimate);
  });
  std::vector<bool> truth_taken(truth.size()), estimate_taken(estimate.size());
  std::vector<StampPair> pairs;
  for (const Candidate& c : candidates) {
    if (truth_taken[c.truth] || estimate_taken[c.estimate]) continue;
    truth_taken[c.truth] = estimate_taken[c.estimate] = true;
    pairs.push_back({c.truth, c.estimate});
  }
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
