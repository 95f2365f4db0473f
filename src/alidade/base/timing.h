// Stopwatches and what is said of many of their readings.
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/base/random.h"

namespace ALIDADE_API alidade {

class Stopwatch {
 public:
  Stopwatch() : start_(Clock::now()) {}
  double Milliseconds() const {
    return std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_;
};

// All in the unit of the samples. p95 and median are order statistics (nearest rank).
struct Summary {
  double median = 0, mean = 0, p95 = 0, max = 0;
  int count = 0;
};
Summary Summarise(std::vector<double> samples);

// Readings of one kind, for days in bounded memory: all of them up to `most`; from then on one of
// every 2, 4, 8, …, drawn from those that follow each other. Any thread may add or ask.
class SampleLog {
 public:
  static constexpr size_t kMost = size_t{1} << 18;  // 2.4 hours at 30 a second, 1 MB
  explicit SampleLog(size_t most = kMost) : most_(most) {}
  void Add(double sample) noexcept;  // to within 1e-7 of it; left out when there is no memory
  std::vector<double> All() const;   // in the order they were added

 private:
  size_t most_;
  mutable std::mutex mutex_;
  std::vector<float> kept_;
  uint32_t stride_ = 1;            // one of so many is kept
  uint32_t place_ = 0, pick_ = 0;  // of the next among them; which of them is kept
  Random random_;
};

double ProcessCpuSeconds();  // user + system time of all threads so far; 0 where unknown
double PeakMegabytes();      // highest resident memory so far, 10^6 bytes; 0 where unknown

}  // namespace alidade
