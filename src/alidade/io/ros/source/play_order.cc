#include "alidade/io/ros/source/play_order.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace alidade {
namespace {

// Messages: a quarter of a second at 30 Hz. The threads of a driver swap one or two.
constexpr size_t kReach = 8;
constexpr size_t kMostInGroup = 32;
constexpr int64_t kMaxStepBack = 1'000'000'000;  // nanoseconds, as in lists

}  // namespace

int64_t PlayOrder::StepBack(size_t a, size_t b) {
  int64_t step = 0;
  if (__builtin_sub_overflow(stamps_.Stamp(a), stamps_.Stamp(b), &step))
    return std::numeric_limits<int64_t>::max();
  return std::max<int64_t>(step, 0);
}

bool PlayOrder::BeginsGroup(size_t i) {
  for (size_t a = i - std::min(i, kReach); a < i; ++a) {
    for (size_t b = i; b < std::min(i + kReach, stamps_.size()); ++b) {
      const int64_t step = StepBack(a, b);
      if (step > 0 && step <= kMaxStepBack) return false;
    }
  }
  return true;
}

void PlayOrder::Sort(size_t first, size_t end) {
  first_ = first;
  order_.resize(end - first);
  std::iota(order_.begin(), order_.end(), first);
  for (size_t a = first; a < end; ++a) {
    for (size_t b = a + 1; b < end; ++b) {
      if (StepBack(a, b) > kMaxStepBack) return;
    }
  }
  std::stable_sort(order_.begin(), order_.end(),
                   [&](size_t a, size_t b) { return stamps_.Stamp(a) < stamps_.Stamp(b); });
}

size_t PlayOrder::At(size_t place) {
  if (place >= first_ && place - first_ < order_.size()) return order_[place - first_];
  size_t first = place, end = place + 1;
  while (!BeginsGroup(first)) {
    if (place - --first >= kMostInGroup) return place;
  }
  while (!BeginsGroup(end)) {
    if (++end - first > kMostInGroup) return place;
  }
  Sort(first, end);
  return order_[place - first];
}

}  // namespace alidade
