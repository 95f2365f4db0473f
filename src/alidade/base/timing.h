// Stopwatch, statistics of its readings, and resource usage of the process.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
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

// Statistics in the unit of the samples. `median` and `p95` are order statistics (nearest rank).
struct Summary {
  double median = 0, mean = 0, p95 = 0, max = 0;
  int count = 0;
};
Summary Summarise(std::vector<double> samples);

// Samples of one quantity in bounded memory. Keeps all of them up to `most`; each time that is
// exceeded the sampling interval doubles (2, 4, 8, …), with one sample drawn at random from each
// interval. Thread-safe.
class SampleLog {
 public:
  static constexpr size_t kMost = size_t{1} << 18;  // 2.4 hours at 30 samples/s, 1 MB
  explicit SampleLog(size_t most = kMost) : most_(most) {}
  void Add(double sample) noexcept;  // stored as float; dropped if out of memory
  std::vector<double> All() const;   // in the order they were added
  struct Reading {
    double value = 0;
    int64_t number = 0;  // of samples added so far, this one included; 0: none yet
  };
  Reading Last() const;

 private:
  size_t most_;
  mutable std::mutex mutex_;
  std::vector<float> kept_;
  uint32_t stride_ = 1;  // interval: one of `stride_` samples is kept
  // Position of the next sample in the current interval, and the position of the one that is kept.
  uint32_t place_ = 0, pick_ = 0;
  Random random_;
  Reading last_;
};

double ProcessCpuSeconds();  // user + system time of all threads so far, seconds
double PeakMegabytes();      // peak resident memory so far, 10^6 bytes; 0 if unavailable

}  // namespace alidade
