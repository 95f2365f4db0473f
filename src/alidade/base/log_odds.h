// Probabilities as log-odds, in which independent evidence adds up.
#pragma once

#include <cmath>

namespace alidade {

inline float ProbabilityOf(float log_odds) { return 1 / (1 + std::exp(-log_odds)); }

// `probability` between 0 and 1, neither included.
inline float LogOddsOf(float probability) { return std::log(probability / (1 - probability)); }

}  // namespace alidade
