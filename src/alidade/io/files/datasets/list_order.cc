#include "alidade/io/files/datasets/list_order.h"

#include <algorithm>
#include <numeric>

namespace alidade {
namespace {

constexpr double kMaxDisorder = 1;          // seconds
constexpr double kMaxStepsBack = 1 / 10.0;  // share of items, in a list of joined recordings

}  // namespace

ListOrder OrderOf(const std::vector<StampedName>& list) {
  ListOrder result;
  result.part.assign(list.size(), 0);
  std::vector<size_t> good;
  for (size_t i = 0; i < list.size(); ++i) {
    if (list[i].problem.empty()) good.push_back(i);
  }
  double time = good.empty() ? 0 : list[good.front()].time;
  for (const StampedName& item : list) {
    if (item.problem.empty()) time = item.time;
    result.times.push_back(time);
  }
  const auto at = [&](size_t k) { return list[good[k]].time; };
  int part = 0, steps_back = 0;
  double latest = good.empty() ? 0 : at(0);  // of this part
  std::vector<size_t> begins;                // indices of the items that begin a part
  for (size_t k = 1; k < good.size(); ++k) {
    const bool back = at(k) < latest - kMaxDisorder;
    steps_back += at(k) < at(k - 1) - kMaxDisorder;
    if (!back) {
      // An item far ahead of both neighbors does not move the part's clock.
      const bool alone = k + 1 < good.size() && at(k) > at(k + 1) + kMaxDisorder &&
                         at(k + 1) >= latest - kMaxDisorder;
      if (!alone) latest = std::max(latest, at(k));
      continue;
    }
    // The next item continues from before this one: this one alone is out of line.
    if (k + 1 < good.size() && at(k + 1) >= latest - kMaxDisorder) continue;
    begins.push_back(good[k]);
    latest = at(k);
  }
  if (steps_back <= kMaxStepsBack * static_cast<double>(list.size())) {
    size_t next = 0;
    for (size_t i = 0; i < list.size(); ++i) {
      if (next < begins.size() && begins[next] == i) ++part, ++next;
      result.part[i] = part;
    }
  }
  result.order.resize(list.size());
  std::iota(result.order.begin(), result.order.end(), size_t{0});
  const auto earlier = [&](size_t a, size_t b) {
    return result.part[a] != result.part[b] ? result.part[a] < result.part[b]
                                            : result.times[a] < result.times[b];
  };
  if (!std::is_sorted(result.order.begin(), result.order.end(), earlier)) {
    std::stable_sort(result.order.begin(), result.order.end(), earlier);
    result.sorted = true;
  }
  return result;
}

}  // namespace alidade
