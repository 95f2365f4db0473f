#include "alidade/io/association.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace alidade {
namespace {

std::vector<std::pair<double, int>> SortedTimes(std::span<const double> times) {
  std::vector<std::pair<double, int>> sorted;
  for (size_t i = 0; i < times.size(); ++i) {
    if (!std::isnan(times[i])) sorted.push_back({times[i], static_cast<int>(i)});
  }
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

}  // namespace

std::vector<std::pair<int, int>> AssociateByTime(std::span<const double> a,
                                                 std::span<const double> b, double max_dt) {
  const auto sorted_a = SortedTimes(a), sorted_b = SortedTimes(b);
  struct Candidate {
    double dt;
    int a, b;
  };
  std::vector<Candidate> candidates;
  size_t begin = 0;
  for (const auto& [time, index] : sorted_a) {
    while (begin < sorted_b.size() && sorted_b[begin].first <= time - max_dt) ++begin;
    for (size_t i = begin; i < sorted_b.size() && sorted_b[i].first < time + max_dt; ++i) {
      const double dt = std::abs(time - sorted_b[i].first);
      if (dt < max_dt) candidates.push_back({dt, index, sorted_b[i].second});
    }
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& x, const Candidate& y) {
    return std::tie(x.dt, x.a, x.b) < std::tie(y.dt, y.a, y.b);
  });
  std::vector<bool> taken_a(a.size()), taken_b(b.size());
  std::vector<std::pair<int, int>> pairs;
  for (const Candidate& c : candidates) {
    const size_t ia = static_cast<size_t>(c.a), ib = static_cast<size_t>(c.b);
    if (taken_a[ia] || taken_b[ib]) continue;
    taken_a[ia] = taken_b[ib] = true;
    pairs.push_back({c.a, c.b});
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace alidade
