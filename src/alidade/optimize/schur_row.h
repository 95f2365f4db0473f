// The inner loop of the Schur complement: products of one camera's coupling with those of others
// that observe the same point. All versions give the same bits.
#pragma once

#include "alidade/base/cpu.h"

namespace alidade {

// blocks[places[b]] -= A B_b' for b in [0, count), in this order. Every B_b is 6x3 (CouplingFactor)
// and every block 6x6 (SquareBlock<6>), column-major without gaps; `a` is one of the former.
using SubtractRow = void (*)(const double* a, const double* b, const int* places, int count,
                             double* blocks);

// Two numbers at once.
void SubtractRow2(const double* a, const double* b, const int* places, int count, double* blocks);

#ifdef ALIDADE_AVX2
// Four numbers at once, with AVX2.
void SubtractRow4(const double* a, const double* b, const int* places, int count, double* blocks);
#endif

// The fastest one that this processor admits.
SubtractRow FastestSubtractRow();

}  // namespace alidade
