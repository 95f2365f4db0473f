#include "alidade/base/random.h"

#include <cmath>

namespace alidade {

Random::Random(uint64_t seed, uint64_t stream) : increment_((stream << 1) | 1) {
  Next();
  state_ += seed;
  Next();
}

uint32_t Random::Next() {
  const uint64_t old = state_;
  state_ = old * 6364136223846793005ULL + increment_;
  const uint32_t mixed = static_cast<uint32_t>(((old >> 18) ^ old) >> 27);
  const uint32_t turn = static_cast<uint32_t>(old >> 59);
  return (mixed >> turn) | (mixed << ((32 - turn) & 31));
}

uint32_t Random::Below(uint32_t bound) {
  // Rejecting draws below 2^32 mod bound removes the bias towards low values.
  const uint32_t threshold = (0u - bound) % bound;
  while (true) {
    const uint32_t drawn = Next();
    if (drawn >= threshold) return drawn % bound;
  }
}

double Random::Uniform() {
  const uint64_t high = Next() >> 5, low = Next() >> 6;
  return (static_cast<double>(high) * 67108864.0 + static_cast<double>(low)) / 9007199254740992.0;
}

double Random::Gaussian() {
  while (true) {
    const double x = Uniform(-1, 1), y = Uniform(-1, 1);
    const double s = x * x + y * y;
    if (s > 0 && s < 1) return x * std::sqrt(-2 * std::log(s) / s);
  }
}

std::vector<int> Random::Sample(int count, int bound) {
  std::vector<int> drawn;
  drawn.reserve(count);
  while (static_cast<int>(drawn.size()) < count) {
    const int candidate = static_cast<int>(Below(static_cast<uint32_t>(bound)));
    bool seen = false;
    for (int other : drawn) seen = seen || other == candidate;
    if (!seen) drawn.push_back(candidate);
  }
  return drawn;
}

}  // namespace alidade
