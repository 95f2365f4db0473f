// Damping of Levenberg–Marquardt steps.
#pragma once

#include <algorithm>

namespace alidade {

// Adapts the damping to how well the quadratic model predicted the cost (Nielsen 1999).
struct Damping {
  double lambda;   // relative to the diagonal
  double minimum;  // a smaller value has no effect and takes many rejections to grow again
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
