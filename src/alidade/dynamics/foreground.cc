// Which part of a box is the thing that was detected, and which is what one sees beside it.
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>

#include "alidade/base/median.h"
#include "alidade/dynamics/objects.h"

namespace alidade {
namespace {

constexpr float kBinsPerFactor = 14;  // depth bins between z and e·z: 7 % each
constexpr int kBins = 64;
constexpr float kNearest = 0.2f;  // metres: begin of the first bin
constexpr float kWiden = 0.06f;   // of the box's size, on every side: boxes cut off hands and feet
constexpr float kReach = 0.22f;   // of the depth, but …
constexpr float kMinReach =
    0.45f;                       // … at least so many metres before and behind the middle: an arm
constexpr float kStep = 0.04f;   // of the depth, from one cell of a surface to the next
constexpr float kStatic = 3.5f;  // log-odds: known to stand still
constexpr float kIslandNear = -0.06f, kIslandFar = 0.3f;  // of the depth, behind the middle
constexpr float kMiddle = 0.3f, kMostStill = 0.7f;
constexpr float kRim = 0.4f;   // of the oval: outside it background may be seen
constexpr float kOval = 2.6f;  // exponent of the oval: between an ellipse and the box

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

// Depth of what fills the middle of the box; 0 when nothing there has depth.
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
  for (int b = 0; b + 1 < kBins; ++b) {  // two neighbours together: a surface may lie on the edge
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
                             std::span<const uint8_t> proven) {
  std::vector<int> found;
  VisitBox(cells, box, [&](int i) {
    const float off = Inside(box, cells.Centre(i), kOval);
    if (off > 1 || (off > kRim && !proven.empty() && proven[i])) return;
    found.push_back(i);
  });
  return found;
}

std::vector<int> FindForeground(const Cells& cells, std::span<const float> depth,
                                std::span<const float> static_log_odds, const cv::Rect2f& box) {
  // Something that stood still before it was detected fills the middle all the same.
  int of_core = 0, still = 0;
  VisitBox(cells, box, [&](int i) {
    if (!(depth[i] > 0) || Inside(box, cells.Centre(i), 2) > kMiddle) return;
    ++of_core;
    still += static_log_odds[i] > kStatic;
  });
  const float least_static = still > kMostStill * of_core ? 1e9f : kStatic;
  const float core = CoreDepth(cells, depth, static_log_odds, least_static, box);
  if (core <= 0) return CellsInOval(cells, box);
  std::vector<int> found;
  const cv::Rect2f wide(box.x - kWiden * box.width, box.y - kWiden * box.height,
                        (1 + 2 * kWiden) * box.width, (1 + 2 * kWiden) * box.height);
  const float reach = std::max(kMinReach, kReach * core), begin = 0.06f * core;
  std::vector<uint8_t> state(cells.count(), 0);  // 1: may be grown into, 2: taken
  std::deque<int> front;
  VisitBox(cells, wide, [&](int i) {
    if (!(depth[i] > 0) || std::abs(depth[i] - core) > reach) return;
    if (static_log_odds[i] > least_static) return;
    state[i] = 1;
    if (std::abs(depth[i] - core) <= begin && Inside(box, cells.Centre(i), 2) < 0.5f) {
      state[i] = 2;
      front.push_back(i);
    }
  });
  while (!front.empty()) {
    const int i = front.front();
    front.pop_front();
    cells.VisitAround(i, 1, [&](int n) {
      if (state[n] != 1 || std::abs(depth[n] - depth[i]) > kStep * core) return;
      state[n] = 2;
      front.push_back(n);
    });
  }
  // What something else cuts off from the middle, such as legs by a chair's back.
  VisitBox(cells, box, [&](int i) {
    if (state[i] != 1) return;
    const float off = (depth[i] - core) / core;
    if (off > kIslandNear && off < kIslandFar && Inside(box, cells.Centre(i), kOval) < 1)
      state[i] = 2;
  });
  // Cells without a reading belong to what is around them.
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
