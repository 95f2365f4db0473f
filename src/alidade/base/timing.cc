#include "alidade/base/timing.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <new>
#include <numeric>

#if defined(__linux__)
#include <sys/resource.h>
#endif

namespace alidade {

Summary Summarise(std::vector<double> samples) {
  Summary summary;
  summary.count = static_cast<int>(samples.size());
  if (samples.empty()) return summary;
  std::sort(samples.begin(), samples.end());
  const auto rank = [&](double share) {
    const auto index = static_cast<size_t>(std::ceil(share * static_cast<double>(samples.size())));
    return samples[std::clamp<size_t>(index, 1, samples.size()) - 1];
  };
  summary.median = rank(0.5);
  summary.p95 = rank(0.95);
  summary.max = samples.back();
  summary.mean =
      std::accumulate(samples.begin(), samples.end(), 0.0) / static_cast<double>(samples.size());
  return summary;
}

void SampleLog::Add(double sample) noexcept {
  const std::lock_guard<std::mutex> lock(mutex_);
  last_ = {sample, last_.number + 1};
  const bool kept = place_ == pick_;
  if (++place_ == stride_) {
    place_ = 0;
    pick_ = random_.Below(stride_);
  }
  if (!kept) return;
  if (kept_.size() == most_) {
    for (size_t i = 0; i < most_ / 2; ++i) kept_[i] = kept_[2 * i + random_.Below(2)];
    kept_.resize(most_ / 2);
    stride_ *= 2;
    place_ = 0;
    pick_ = random_.Below(stride_);
  }
  try {
    kept_.push_back(static_cast<float>(sample));
  } catch (const std::bad_alloc&) {
  }
}

std::vector<double> SampleLog::All() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return {kept_.begin(), kept_.end()};
}

SampleLog::Reading SampleLog::Last() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return last_;
}

double ProcessCpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double PeakMegabytes() {
#if defined(__linux__)
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) == 0) return static_cast<double>(usage.ru_maxrss) * 1024e-6;
#endif
  return 0;
}

}  // namespace alidade
