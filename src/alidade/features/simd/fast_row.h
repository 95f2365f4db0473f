// FAST scores of one image row, several pixels at once. All give the same result.
#pragma once

#include <cstddef>
#include <cstdint>

#include "alidade/base/cpu.h"

namespace alidade {

// Scores plus one of the pixels [first, end) of a row into `score`, which is 0 there before: 0
// where the score is at most `threshold`. Their columns into `columns`, which has room for all,
// ascending. Returns how many there are. `pixels`: of column 0. `stride`: bytes from a row to
// the next.
using FastRow = int (*)(const uint8_t* pixels, int first, int end, ptrdiff_t stride,
                        uint8_t threshold, uint8_t* score, int* columns);

// 16 pixels at once. `end` at least 19, so that the circle of every pixel is in the row.
int FastRow16(const uint8_t* pixels, int first, int end, ptrdiff_t stride, uint8_t threshold,
              uint8_t* score, int* columns);

#ifdef ALIDADE_AVX2
// 32 pixels at once, with AVX2. `end` at least 35.
int FastRow32(const uint8_t* pixels, int first, int end, ptrdiff_t stride, uint8_t threshold,
              uint8_t* score, int* columns);
#endif

// The fastest one that this processor and a row that ends at `end` admit; null: the row is too
// short.
FastRow FastRowFor(int end);

}  // namespace alidade
