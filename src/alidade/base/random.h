// Pseudo-random numbers that are the same on every machine and with every standard library.
#pragma once

#include <cstdint>
#include <vector>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

// PCG32 (O'Neill 2014). Equal seeds and streams give equal sequences. Not thread-safe.
class Random {
 public:
  explicit Random(uint64_t seed = 1, uint64_t stream = 0);
  uint32_t Next();                 // uniform over all 32 bits
  uint32_t Below(uint32_t bound);  // uniform in [0, bound), bound > 0, unbiased
  double Uniform();                // uniform in [0, 1)
  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }
  double Gaussian();  // mean 0, standard deviation 1 (Marsaglia's polar method)
  // `count` distinct numbers in [0, bound), in the order drawn. Requires count <= bound.
  std::vector<int> Sample(int count, int bound);

 private:
  uint64_t state_ = 0;
  uint64_t increment_ = 1;
};

}  // namespace alidade
