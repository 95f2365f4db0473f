// Conversion between probabilities and log-odds, in which independent evidence is additive.
#pragma once

#include <cmath>

namespace alidade {

inline float ProbabilityOf(float log_odds) { return 1 / (1 + std::exp(-log_odds)); }

// `probability` in the open interval (0, 1).
inline float LogOddsOf(float probability) { return std::log(probability / (1 - probability)); }

}  // namespace alidade
