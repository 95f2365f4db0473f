#include "alidade/features/describe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "alidade/base/random.h"

namespace alidade {
namespace {

constexpr int kBits = 256;

struct Pair {
  double x0, y0, x1, y1;
};

const std::array<Pair, kBits>& Pattern() {
  static const std::array<Pair, kBits> kPattern = [] {
    std::array<Pair, kBits> pattern{};
    Random random(1);
    const auto place = [&](double& x, double& y) {
      do {
        x = std::round(random.Gaussian() * 6.5);
        y = std::round(random.Gaussian() * 6.5);
      } while (x * x + y * y > kPatchRadius * kPatchRadius);
    };
    for (Pair& p : pattern) {
      do {
        place(p.x0, p.y0);
        place(p.x1, p.y1);
      } while (p.x0 == p.x1 && p.y0 == p.y1);
    }
    return pattern;
  }();
  return kPattern;
}

// Half-widths of the disc's rows.
const std::array<int, kPatchRadius + 1>& DiscRows() {
  static const std::array<int, kPatchRadius + 1> kRows = [] {
    std::array<int, kPatchRadius + 1> rows{};
    for (int v = 0; v <= kPatchRadius; ++v) {
      rows[v] = static_cast<int>(std::sqrt(kPatchRadius * kPatchRadius - v * v + 0.5));
    }
    return rows;
  }();
  return kRows;
}

}  // namespace

float PatchAngle(const cv::Mat& level, int x, int y) {
  const std::array<int, kPatchRadius + 1>& rows = DiscRows();
  int moment_x = 0, moment_y = 0;
  for (int v = -kPatchRadius; v <= kPatchRadius; ++v) {
    const uint8_t* row = level.ptr<uint8_t>(y + v) + x;
    const int half = rows[std::abs(v)];
    int sum = 0;
    for (int u = -half; u <= half; ++u) {
      sum += row[u];
      moment_x += u * row[u];
    }
    moment_y += v * sum;
  }
  return std::atan2(static_cast<float>(moment_y), static_cast<float>(moment_x));
}

void SmoothForDescriptors(const cv::Mat& level, cv::Mat& smooth) {
  cv::GaussianBlur(level, smooth, cv::Size(7, 7), 2, 2, cv::BORDER_REFLECT_101);
}

SteeredPattern::SteeredPattern(int stride) : stride_(stride), offsets_(kTurns * kBits * 2) {
  int* offset = offsets_.data();
  for (int turn = 0; turn < kTurns; ++turn) {
    const double angle = 2 * std::numbers::pi * turn / kTurns;
    const double c = std::cos(angle), s = std::sin(angle);
    const auto at = [&](double x, double y) {
      return static_cast<int>(std::lround(s * x + c * y)) * stride_ +
             static_cast<int>(std::lround(c * x - s * y));
    };
    for (const Pair& p : Pattern()) {
      *offset++ = at(p.x0, p.y0);
      *offset++ = at(p.x1, p.y1);
    }
  }
}

Descriptor SteeredPattern::Describe(const uint8_t* centre, float angle) const {
  const int turn =
      static_cast<int>(std::lround(angle * (kTurns / (2 * std::numbers::pi)))) & (kTurns - 1);
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
