#include "alidade/features/describe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <opencv2/core/hal/intrin.hpp>

namespace alidade {
namespace {

constexpr int kBits = 256;

struct Pair {
  int x0, y0, x1, y1;  // pixels from the patch center, unrotated
};

constexpr std::array<Pair, kBits> kPattern = {{
#include "alidade/features/orb_pattern.inc"
}};

// Weights for the intensity moments of the middle row of the disc and those below: 32 columns from
// -15 to 16, 0 outside of the disc.
struct DiscWeights {
  static constexpr int kColumns = 32;
  using Row = std::array<int16_t, kColumns>;
  std::array<Row, kPatchRadius + 1> column{}, row{};  // u and v inside the disc; v from 0 to radius
};

constexpr DiscWeights MakeDisc() {
  DiscWeights disc;
  for (int v = 0; v <= kPatchRadius; ++v) {
    for (int u = -kPatchRadius; u <= kPatchRadius; ++u) {
      if (u * u + v * v > kPatchRadius * kPatchRadius) continue;
      disc.column[v][u + kPatchRadius] = static_cast<int16_t>(u);
      disc.row[v][u + kPatchRadius] = static_cast<int16_t>(v);
    }
  }
  return disc;
}

constexpr DiscWeights kDisc = MakeDisc();

}  // namespace

float PatchAngle(const cv::Mat& level, int x, int y) {
  constexpr int kLanes = 8;
  const uint8_t* middle = level.ptr<uint8_t>(y) + x - kPatchRadius;
  const auto stride = static_cast<ptrdiff_t>(level.step[0]);
  cv::v_int32x4 moment_x = cv::v_setzero_s32(), moment_y = moment_x;
  const auto load = [](const uint8_t* p) { return cv::v_reinterpret_as_s16(cv::v_load_expand(p)); };
  for (int u = 0; u < DiscWeights::kColumns; u += kLanes)
    moment_x = cv::v_dotprod(load(middle + u), cv::v_load(kDisc.column[0].data() + u), moment_x);
  // Rows v and -v have the same weights u and opposite weights v.
  for (int v = 1; v <= kPatchRadius; ++v) {
    const uint8_t *below = middle + v * stride, *above = middle - v * stride;
    const int16_t *column = kDisc.column[v].data(), *row = kDisc.row[v].data();
#pragma GCC unroll 4
    for (int u = 0; u < DiscWeights::kColumns; u += kLanes) {
      const cv::v_int16x8 a = load(above + u), b = load(below + u);
      moment_x = cv::v_dotprod(a + b, cv::v_load(column + u), moment_x);
      moment_y = cv::v_dotprod(b - a, cv::v_load(row + u), moment_y);
    }
  }
  return std::atan2(static_cast<float>(cv::v_reduce_sum(moment_y)),
                    static_cast<float>(cv::v_reduce_sum(moment_x)));
}

SteeredPattern::SteeredPattern(int stride) : stride_(stride), offsets_(kTurns * kBits * 2) {
  int* offset = offsets_.data();
  for (int turn = 0; turn < kTurns; ++turn) {
    const double angle = 2 * std::numbers::pi * turn / kTurns;
    const double c = std::cos(angle), s = std::sin(angle);
    const auto at = [&](int x, int y) {
      return static_cast<int>(std::lround(s * x + c * y)) * stride_ +
             static_cast<int>(std::lround(c * x - s * y));
    };
    for (const Pair& p : kPattern) {
      *offset++ = at(p.x0, p.y0);
      *offset++ = at(p.x1, p.y1);
    }
  }
}

Descriptor SteeredPattern::Describe(const uint8_t* centre, float angle) const {
  const double turns = angle * (kTurns / (2 * std::numbers::pi));
  const int turn = static_cast<int>(std::lround(turns)) & (kTurns - 1);
  const int* offset = offsets_.data() + turn * kBits * 2;
  Descriptor descriptor;
  for (uint64_t& word : descriptor.words) {
    // From the last bit to the first: doubling and adding takes fewer instructions than shifting
    // each bit to its place.
    uint64_t bits = 0;
#pragma GCC unroll 4
    for (int i = 2 * 63; i >= 0; i -= 2)
      bits = bits + bits + (centre[offset[i]] < centre[offset[i + 1]]);
    word = bits;
    offset += 2 * 64;
  }
  return descriptor;
}

}  // namespace alidade
