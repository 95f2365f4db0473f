// Damping of Levenberg–Marquardt steps.
#pragma once

#include <algorithm>

namespace alidade {

// Follows how well the quadratic model foretold the cost (Nielsen 1999).
struct Damping {
  double lambda;   // relative to the diagonal
  double minimum;  // below this it does nothing, and takes long to come back from
  double growth = 2;

  void Accepted(double actual, double predicted) {
    const double surprise = 2 * actual / predicted - 1;
    lambda *= std::max(1.0 / 3, 1 - surprise * surprise * surprise);
    lambda = std::max(lambda, minimum);
    growth = 2;
  }
  void Rejected() {
    lambda *= growth;
    growth *= 2;
  }
};

}  // namespace alidade
