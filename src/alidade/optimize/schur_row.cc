#include "alidade/optimize/schur_row.h"

#include "alidade/optimize/bundle_kernels.h"

namespace alidade {

static_assert(sizeof(CouplingFactor) == 18 * sizeof(double));
static_assert(sizeof(SquareBlock<6>) == 36 * sizeof(double));

void SubtractRow2(const double* a, const double* b, const int* places, int count, double* blocks) {
  const auto& A = *reinterpret_cast<const CouplingFactor*>(a);
  const auto* B = reinterpret_cast<const CouplingFactor*>(b);
  auto* S = reinterpret_cast<SquareBlock<6>*>(blocks);
  for (int n = 0; n < count; ++n) SubtractProduct(A, B[n], S[places[n]]);
}

SubtractRow FastestSubtractRow() {
#ifdef ALIDADE_AVX2
  if (HasAvx2()) return SubtractRow4;
#endif
  return SubtractRow2;
}

}  // namespace alidade
