// Segments a detection's box into the object and the background.
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>

#include "alidade/base/median.h"
#include "alidade/dynamics/objects.h"

namespace alidade {
namespace {

// Histogram of depths with bins of 7 %: 14 bins between z and e·z.
constexpr float kBinsPerFactor = 14;
constexpr int kBins = 64;
constexpr float kNearest = 0.2f;  // meters, start of the first bin; the last bin starts at 18 m

// |u|^e + |v|^e for u, v from -1 to 1 across the box; for e = 2 it is below 1 inside the inscribed
// ellipse.
float Inside(const cv::Rect2f& box, cv::Point2f p, float exponent) {
  const float u = std::abs(p.x - box.x - box.width / 2) / (box.width / 2);
  const float v = std::abs(p.y - box.y - box.height / 2) / (box.height / 2);
  return std::pow(u, exponent) + std::pow(v, exponent);
}

template <typename Visit>
void VisitBox(const Cells& cells, const cv::Rect2f& box, Visit&& visit) {
  const int first = cells.At(box.x, box.y), last = cells.At(box.br().x, box.br().y);
  for (int r = first / Cells::kColumns; r <= last / Cells::kColumns; ++r) {
    for (int c = first % Cells::kColumns; c <= last % Cells::kColumns; ++c)
      visit(r * Cells::kColumns + c);
  }
}

int BinOf(float z) {
  return std::clamp(static_cast<int>(std::log(z / kNearest) * kBinsPerFactor), 0, kBins - 1);
}

// Depth of the object in the middle of the box: the median of the two adjacent depth bins with the
// largest weight, where a cell weighs exp(-3 (u² + v²)). 0 when no cell there has depth.
float CoreDepth(const Cells& cells, std::span<const float> depth,
                std::span<const float> static_log_odds, float least_static, const cv::Rect2f& box) {
  std::array<float, kBins> weights{};
  VisitBox(cells, box, [&](int i) {
    const float off = Inside(box, cells.Centre(i), 2);
    if (depth[i] > 0 && off < 1 && static_log_odds[i] <= least_static)
      weights[BinOf(depth[i])] += std::exp(-3 * off);
  });
  int best = -1;
  float most = 0;
  // Two adjacent bins, because a surface may straddle their boundary.
  for (int b = 0; b + 1 < kBins; ++b) {
    if (weights[b] + weights[b + 1] <= most) continue;
    most = weights[b] + weights[b + 1];
    best = b;
  }
  if (best < 0) return 0;
  std::vector<float> values;
  VisitBox(cells, box, [&](int i) {
    if (!(depth[i] > 0) || Inside(box, cells.Centre(i), 2) >= 1) return;
    if (BinOf(depth[i]) == best || BinOf(depth[i]) == best + 1) values.push_back(depth[i]);
  });
  return UpperMedian(values);
}

}  // namespace

std::vector<int> CellsInBox(const Cells& cells, const cv::Rect2f& box) {
  std::vector<int> found;
  VisitBox(cells, box, [&](int i) { found.push_back(i); });
  return found;
}

std::vector<int> CellsInOval(const Cells& cells, const cv::Rect2f& box,
                             std::span<const uint8_t> proven, const BoxSettings& settings) {
  std::vector<int> found;
  VisitBox(cells, box, [&](int i) {
    const float off = Inside(box, cells.Centre(i), settings.oval);
    if (off > 1 || (off > settings.rim && !proven.empty() && proven[i])) return;
    found.push_back(i);
  });
  return found;
}

std::vector<int> FindForeground(const Cells& cells, std::span<const float> depth,
                                std::span<const float> static_log_odds, const cv::Rect2f& box,
                                const BoxSettings& settings) {
  // An object that was static before it was detected fills the middle, too: then ignore the static
  // belief.
  int of_core = 0, still = 0;
  VisitBox(cells, box, [&](int i) {
    if (!(depth[i] > 0) || Inside(box, cells.Centre(i), 2) > settings.middle) return;
    ++of_core;
    still += static_log_odds[i] > settings.known_static;
  });
  const float least_static = still > settings.most_still * of_core ? 1e9f : settings.known_static;
  const float core = CoreDepth(cells, depth, static_log_odds, least_static, box);
  if (core <= 0) return CellsInOval(cells, box, {}, settings);
  std::vector<int> found;
  const float widen = settings.widen;
  const cv::Rect2f wide(box.x - widen * box.width, box.y - widen * box.height,
                        (1 + 2 * widen) * box.width, (1 + 2 * widen) * box.height);
  const float reach = std::max(settings.min_reach, settings.reach * core);
  const float begin = settings.seed * core;
  std::vector<uint8_t> state(cells.count(), 0);  // 1: candidate for growing, 2: part of the object
  std::deque<int> front;
  VisitBox(cells, wide, [&](int i) {
    if (!(depth[i] > 0) || std::abs(depth[i] - core) > reach) return;
    if (static_log_odds[i] > least_static) return;
    state[i] = 1;
    if (std::abs(depth[i] - core) <= begin &&
        Inside(box, cells.Centre(i), 2) < settings.seed_middle) {
      state[i] = 2;
      front.push_back(i);
    }
  });
  while (!front.empty()) {
    const int i = front.front();
    front.pop_front();
    cells.VisitAround(i, 1, [&](int n) {
      if (state[n] != 1 || std::abs(depth[n] - depth[i]) > settings.step * core) return;
      state[n] = 2;
      front.push_back(n);
    });
  }
  // Add parts that are separated from the middle by an occluder, such as legs behind a chair's
  // back.
  VisitBox(cells, box, [&](int i) {
    if (state[i] != 1) return;
    const float off = (depth[i] - core) / core;
    if (off > -settings.island_before && off < settings.island_behind &&
        Inside(box, cells.Centre(i), settings.oval) < 1)
      state[i] = 2;
  });
  // Cells without depth get the label of the majority around them.
  VisitBox(cells, wide, [&](int i) {
    bool taken = state[i] == 2;
    if (!taken && !(depth[i] > 0)) {
      int of_it = 0, known = 0;
      cells.VisitAround(i, 1, [&](int n) {
        known += depth[n] > 0;
        of_it += state[n] == 2;
      });
      taken = of_it > 0 && 2 * of_it >= known;
    }
    if (taken) found.push_back(i);
  });
  return found;
}

}  // namespace alidade
