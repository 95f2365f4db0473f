#include "alidade/features/describe.h"

#include <algorithm>
#include <array>
#include <cmath>
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

// Weights for the intensity moments of the disc, row by row: 32 columns from -15 to 16.
struct DiscWeights {
  static constexpr int kColumns = 32;
  using Row = std::array<uint8_t, kColumns>;
  std::array<Row, 2 * kPatchRadius + 1> inside{};  // 1 inside the disc
  std::array<Row, 2 * kPatchRadius + 1> column{};  // u + kBias inside the disc
  static constexpr int kBias = 16;                 // keeps the weights positive
};

const DiscWeights& Disc() {
  static const DiscWeights kDisc = [] {
    DiscWeights disc;
    for (int v = -kPatchRadius; v <= kPatchRadius; ++v) {
      for (int u = -kPatchRadius; u <= kPatchRadius; ++u) {
        if (u * u + v * v > kPatchRadius * kPatchRadius) continue;
        disc.inside[v + kPatchRadius][u + kPatchRadius] = 1;
        disc.column[v + kPatchRadius][u + kPatchRadius] =
            static_cast<uint8_t>(u + DiscWeights::kBias);
      }
    }
    return disc;
  }();
  return kDisc;
}

}  // namespace

float PatchAngle(const cv::Mat& level, int x, int y) {
  const DiscWeights& disc = Disc();
  cv::v_uint32x4 all = cv::v_setzero_u32(), by_column = all, by_row = all;
  for (int row = 0; row <= 2 * kPatchRadius; ++row) {
    const uint8_t* p = level.ptr<uint8_t>(y + row - kPatchRadius) + x - kPatchRadius;
    const cv::v_uint8x16 left = cv::v_load(p), right = cv::v_load(p + 16);
    const uint8_t* inside = disc.inside[row].data();
    const uint8_t* column = disc.column[row].data();
    const cv::v_uint32x4 sum = cv::v_dotprod_expand_fast(
        right, cv::v_load(inside + 16), cv::v_dotprod_expand_fast(left, cv::v_load(inside)));
    by_column = cv::v_dotprod_expand_fast(left, cv::v_load(column), by_column);
    by_column = cv::v_dotprod_expand_fast(right, cv::v_load(column + 16), by_column);
    by_row = by_row + sum * cv::v_setall_u32(static_cast<unsigned>(row));
    all = all + sum;
  }
  const int sum = static_cast<int>(cv::v_reduce_sum(all));
  const int moment_x = static_cast<int>(cv::v_reduce_sum(by_column)) - DiscWeights::kBias * sum;
  const int moment_y = static_cast<int>(cv::v_reduce_sum(by_row)) - kPatchRadius * sum;
  return std::atan2(static_cast<float>(moment_y), static_cast<float>(moment_x));
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
    uint64_t bits = 0;
    for (int bit = 0; bit < 64; ++bit, offset += 2) {
      bits |= static_cast<uint64_t>(centre[offset[0]] < centre[offset[1]]) << bit;
    }
    word = bits;
  }
  return descriptor;
}

}  // namespace alidade
