// Stopwatches and what is said of many of their readings.
#pragma once

#include <chrono>
#include <vector>

namespace alidade {

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

double ProcessCpuSeconds();  // user + system time of all threads so far; 0 where unknown
double PeakMegabytes();      // highest resident memory so far, 10^6 bytes; 0 where unknown

}  // namespace alidade
