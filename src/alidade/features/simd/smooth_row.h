// The filters of smooth.h for one row with AVX2, at least 32 columns wide: the same bits.
#pragma once

#include <cstdint>

#include "alidade/base/cpu.h"

#ifdef ALIDADE_AVX2
namespace alidade {

inline constexpr int kSumRim =
    16;  // columns of sums on both sides that the functions may overwrite

// `sums`: column 0 of width + 2 kSumRim sums, overwritten.
void BinomialRowAvx2(const uint8_t* above, const uint8_t* here, const uint8_t* below, int width,
                     uint16_t* sums, uint8_t* out);

// Column sums of the next row: a row comes and one goes. `sums` is not `before`.
void BoxColumnsAvx2(const uint16_t* before, const uint8_t* comes, const uint8_t* goes, int width,
                    uint16_t* sums);
// `sums` as for BinomialRowAvx2(), of which the rim is overwritten.
void BoxRowAvx2(uint16_t* sums, int width, uint8_t* out);

}  // namespace alidade
#endif
