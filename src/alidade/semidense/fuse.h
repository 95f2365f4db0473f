// Several hypotheses of one pixel's depth as one (Mur-Artal & Tardós, RSS 2015, §III-B).
#pragma once

#include <span>

#include "alidade/semidense/hypothesis.h"

namespace alidade {

// Whether two say the same, by chi² with two degrees of freedom.
inline bool Compatible(const Hypothesis& a, const Hypothesis& b, float chi2) {
  const float d = a.inverse_depth - b.inverse_depth;
  const float va = a.sigma * a.sigma, vb = b.sigma * b.sigma;
  return d * d * (va + vb) < chi2 * va * vb;  // d²/va + d²/vb < chi2 (eq. 13)
}

// The inverse-variance mean of the largest set of them compatible with one of them; nothing when it
// has fewer than `enough`. Unknown ones are passed over. Of sets of one size, that with the
// smallest variance.
Hypothesis Fuse(std::span<const Hypothesis> hypotheses, float chi2, int enough);

}  // namespace alidade
