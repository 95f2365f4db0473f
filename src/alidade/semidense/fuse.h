// Fusion of several depth hypotheses of a pixel (Mur-Artal & Tardós, RSS 2015, §III-B).
#pragma once

#include <span>

#include "alidade/semidense/hypothesis.h"

namespace alidade {

// Chi² test of equality with two degrees of freedom.
inline bool Compatible(const Hypothesis& a, const Hypothesis& b, float chi2) {
  const float d = a.inverse_depth - b.inverse_depth;
  const float va = a.sigma * a.sigma, vb = b.sigma * b.sigma;
  return d * d * (va + vb) < chi2 * va * vb;  // d²/va + d²/vb < chi2 (eq. 13)
}

// Inverse-variance weighted mean of the largest set of hypotheses that are compatible with one of
// them; unknown if the set has fewer than `enough` members. Among sets of equal size, the one with
// the smallest variance. Unknown hypotheses are ignored.
Hypothesis Fuse(std::span<const Hypothesis> hypotheses, float chi2, int enough);

}  // namespace alidade
