#include "alidade/io/association.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>

namespace alidade {
namespace {

// All items of the two lists that have the same time: ascending indices into list `a` and list `b`.
struct Moment {
  double time;
  std::vector<int> a, b;
  size_t next_a = 0, next_b = 0;  // indices before these are already paired
  // Neighboring moments in the chain of those with unpaired items; -1: none.
  int earlier = -1, later = -1;
  bool HasA() const { return next_a < a.size(); }
  bool HasB() const { return next_b < b.size(); }
};

std::vector<Moment> MomentsOf(std::span<const double> a, std::span<const double> b) {
  std::vector<std::tuple<double, bool, int>> sorted;  // time, whether it belongs to list b, index
  for (const bool of_b : {false, true}) {
    const std::span<const double> times = of_b ? b : a;
    for (size_t i = 0; i < times.size(); ++i) {
      if (!std::isnan(times[i])) sorted.push_back({times[i], of_b, static_cast<int>(i)});
    }
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<Moment> moments;
  for (const auto& [time, of_b, index] : sorted) {
    if (moments.empty() || moments.back().time != time) moments.push_back({time, {}, {}});
    (of_b ? moments.back().b : moments.back().a).push_back(index);
  }
  return moments;
}

// Greedily pairs the closest items of a chain of moments. The closest remaining pair always belongs
// to neighboring moments: an item between them in time would be closer to one of the two. The queue
// therefore holds neighboring pairs only, and pairing n items takes O(n log n) steps for any
// distribution of times.
class Pairing {
 public:
  Pairing(std::vector<Moment> moments, double max_dt)
      : moments_(std::move(moments)), max_dt_(max_dt) {}

  std::vector<std::pair<int, int>> Run() {
    if (max_dt_ > 0) PairEqualTimes();
    int before = -1;
    for (int i = 0; i < static_cast<int>(moments_.size()); ++i) {
      if (!At(i).HasA() && !At(i).HasB()) continue;
      At(i).earlier = before;
      if (before >= 0) At(before).later = i;
      Offer(before, i);
      before = i;
    }
    while (!queue_.empty()) {
      const Offered best = queue_.top();
      queue_.pop();
      if (IsOpen(best)) Take(best);
    }
    std::sort(pairs_.begin(), pairs_.end());
    return std::move(pairs_);
  }

 private:
  struct Offered {
    double dt;
    int a, b;  // indices in the two lists
    int moment_a, moment_b;
    bool operator<(const Offered& other) const {  // makes the closest pair the first of the queue
      return std::tie(dt, a, b) > std::tie(other.dt, other.a, other.b);
    }
  };

  Moment& At(int moment) { return moments_[static_cast<size_t>(moment)]; }

  // Afterwards no moment has unpaired items of both lists.
  void PairEqualTimes() {
    for (Moment& moment : moments_) {
      while (moment.HasA() && moment.HasB())
        pairs_.push_back({moment.a[moment.next_a++], moment.b[moment.next_b++]});
    }
  }

  void Offer(int first, int second) {
    if (first < 0 || second < 0) return;
    if (!At(first).HasA()) std::swap(first, second);
    const Moment &with_a = At(first), &with_b = At(second);
    const double dt = std::abs(with_a.time - with_b.time);
    if (!with_a.HasA() || !with_b.HasB() || !(dt < max_dt_)) return;
    queue_.push({dt, with_a.a[with_a.next_a], with_b.b[with_b.next_b], first, second});
  }

  bool IsOpen(const Offered& offered) {
    const Moment &with_a = At(offered.moment_a), &with_b = At(offered.moment_b);
    return with_a.HasA() && with_a.a[with_a.next_a] == offered.a && with_b.HasB() &&
           with_b.b[with_b.next_b] == offered.b;
  }

  void Take(const Offered& pair) {
    pairs_.push_back({pair.a, pair.b});
    ++At(pair.moment_a).next_a;
    ++At(pair.moment_b).next_b;
    for (const int moment : {pair.moment_a, pair.moment_b}) Link(moment);
  }

  // Updates the queue after an item of `moment` was paired. An empty moment is unlinked from the
  // chain, and its two neighbors are queued as a pair. Otherwise the moment's next item is queued
  // with both neighbors.
  void Link(int moment) {
    const Moment& now = At(moment);
    if (now.HasA() || now.HasB()) {
      Offer(now.earlier, moment);
      Offer(moment, now.later);
      return;
    }
    if (now.earlier >= 0) At(now.earlier).later = now.later;
    if (now.later >= 0) At(now.later).earlier = now.earlier;
    Offer(now.earlier, now.later);
  }

  std::vector<Moment> moments_;
  double max_dt_;
  std::priority_queue<Offered> queue_;
  std::vector<std::pair<int, int>> pairs_;
};

}  // namespace

std::vector<std::pair<int, int>> AssociateByTime(std::span<const double> a,
                                                 std::span<const double> b, double max_dt) {
  return Pairing(MomentsOf(a, b), max_dt).Run();
}

}  // namespace alidade
