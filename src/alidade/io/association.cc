#include "alidade/io/association.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>

namespace alidade {
namespace {

// All that happened at one time, as indices into the list it is of; ascending.
struct Moment {
  double time;
  std::vector<int> a, b;
  size_t next_a = 0, next_b = 0;  // those before them have partners
  int earlier = -1, later = -1;   // moments with something left
  bool HasA() const { return next_a < a.size(); }
  bool HasB() const { return next_b < b.size(); }
};

std::vector<Moment> MomentsOf(std::span<const double> a, std::span<const double> b) {
  std::vector<std::tuple<double, bool, int>> sorted;  // time, whether it is of b, index
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

// Takes the closest pairs off a chain of moments. The closest pair of all that are left is always
// of neighbours: whatever lay between the two would be closer to one of them. So only neighbours
// need a place in the queue, and n times take n log n steps however close they lie.
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
    int a, b;  // indices of the pair
    int moment_a, moment_b;
    bool operator<(const Offered& other) const {  // the queue's first is the closest
      return std::tie(dt, a, b) > std::tie(other.dt, other.a, other.b);
    }
  };

  Moment& At(int moment) { return moments_[static_cast<size_t>(moment)]; }

  // Afterwards no moment has both.
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

  // Takes a moment off the chain when nothing is left of it, and offers the pairs this makes
  // neighbours; else those it is part of with what comes next in it.
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
