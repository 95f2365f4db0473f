#include "alidade/features/matching.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "alidade/base/parallel.h"

namespace alidade {
namespace {

constexpr int kNone = std::numeric_limits<int>::max();
constexpr int kRows = 128;  // rows of the distance matrix per task

struct Best {
  int index = -1, distance = kNone, second = kNone;
  void Offer(int i, int d) {
    if (d < distance) {
      second = distance;
      distance = d;
      index = i;
    } else if (d < second) {
      second = d;
    }
  }
};

bool Passes(const Best& best, const MatchSettings& settings) {
  return best.index >= 0 && best.distance <= settings.max_distance &&
         (best.second == kNone || settings.ratio >= 1 ||
          best.distance < settings.ratio * best.second);
}

// Converts the best candidates of each a (and of each b for the cross-check) to the list of
// matches.
std::vector<IndexMatch> Choose(const Frame& a, const Frame& b, std::span<const int> of_a,
                               std::span<const Best> best_a, std::span<const Best> best_b,
                               std::span<const int> of_b, const MatchSettings& settings) {
  std::vector<IndexMatch> matches;
  std::vector<float> turns;
  for (size_t i = 0; i < of_a.size(); ++i) {
    const Best& best = best_a[i];
    if (!Passes(best, settings)) continue;
    if (settings.cross_check && best_b[best.index].index != static_cast<int>(i)) continue;
    const int ia = of_a[i], ib = of_b[best.index];
    matches.push_back({ia, ib, best.distance});
    turns.push_back(a.keypoints[ia].angle - b.keypoints[ib].angle);
  }
  if (settings.check_orientation) {
    const std::vector<bool> keep = ConsistentTurns(turns);
    size_t kept = 0;
    for (size_t i = 0; i < matches.size(); ++i) {
      if (keep[i]) matches[kept++] = matches[i];
    }
    matches.resize(kept);
  }
  std::sort(matches.begin(), matches.end(),
            [](const IndexMatch& p, const IndexMatch& q) { return p.a < q.a; });
  return matches;
}

std::vector<int> All(size_t count) {
  std::vector<int> indices(count);
  std::iota(indices.begin(), indices.end(), 0);
  return indices;
}

}  // namespace

std::vector<IndexMatch> MatchBruteForce(const Frame& a, const Frame& b,
                                        const MatchSettings& settings) {
  return MatchSubsets(a, All(a.descriptors.size()), b, All(b.descriptors.size()), settings);
}

std::vector<IndexMatch> MatchSubsets(const Frame& a, std::span<const int> of_a, const Frame& b,
                                     std::span<const int> of_b, const MatchSettings& settings) {
  const int count_a = static_cast<int>(of_a.size()), count_b = static_cast<int>(of_b.size());
  if (count_a == 0 || count_b == 0) return {};
  std::vector<Descriptor> packed_b(of_b.size());
  for (int j = 0; j < count_b; ++j) packed_b[j] = b.descriptors[of_b[j]];

  std::vector<Best> best_a(of_a.size());
  const int chunks = (count_a + kRows - 1) / kRows;
  std::vector<std::vector<Best>> best_b(chunks);
  const bool cross_check = settings.cross_check;
  ParallelFor(chunks, [&](int chunk) {
    std::vector<Best>& best_here = best_b[chunk];
    if (cross_check) best_here.resize(of_b.size());
    for (int i = chunk * kRows; i < std::min(count_a, (chunk + 1) * kRows); ++i) {
      const Descriptor descriptor = a.descriptors[of_a[i]];
      Best best;
      for (int j = 0; j < count_b; ++j) {
        const int d = HammingDistance(descriptor, packed_b[j]);
        best.Offer(j, d);
        if (cross_check && d < best_here[j].distance) {
          best_here[j].distance = d;
          best_here[j].index = i;
        }
      }
      best_a[i] = best;
    }
  });
  for (int chunk = 1; cross_check && chunk < chunks; ++chunk) {
    for (int j = 0; j < count_b; ++j) {
      if (best_b[chunk][j].distance < best_b[0][j].distance) best_b[0][j] = best_b[chunk][j];
    }
  }
  return Choose(a, b, of_a, best_a, best_b[0], of_b, settings);
}

std::vector<IndexMatch> MatchWindow(const Frame& a, const Frame& b,
                                    std::span<const Eigen::Vector2f> guess, float radius,
                                    const MatchSettings& settings) {
  const std::vector<int> of_a = All(a.keypoints.size()), of_b = All(b.keypoints.size());
  std::vector<Best> best_a(of_a.size()), best_b(of_b.size());
  for (int i = 0; i < static_cast<int>(of_a.size()); ++i) {
    const int level = a.keypoints[i].level;
    b.grid.VisitNear(guess[i].x(), guess[i].y(), radius, [&](int j) {
      const Keypoint& k = b.keypoints[j];
      if (std::abs(k.level - level) > 1) return;
      if (std::abs(k.x - guess[i].x()) > radius || std::abs(k.y - guess[i].y()) > radius) return;
      const int d = HammingDistance(a.descriptors[i], b.descriptors[j]);
      best_a[i].Offer(j, d);
      best_b[j].Offer(i, d);
    });
  }
  return Choose(a, b, of_a, best_a, best_b, of_b, settings);
}

std::vector<bool> ConsistentTurns(std::span<const float> turns) {
  constexpr int kBins = 30;
  constexpr double kShare = 0.1;  // bins with less than this share of the fullest one are no peaks
  std::array<int, kBins> filled{};
  std::vector<int> bins(turns.size());
  for (size_t i = 0; i < turns.size(); ++i) {
    const double share = turns[i] / (2 * std::numbers::pi);
    bins[i] = static_cast<int>((share - std::floor(share)) * kBins) % kBins;
    ++filled[bins[i]];
  }
  std::array<int, kBins> order;
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int p, int q) { return filled[p] > filled[q]; });
  std::array<bool, kBins> good{};
  for (int rank = 0; rank < 3; ++rank) {
    good[order[rank]] = rank == 0 || filled[order[rank]] >= kShare * filled[order[0]];
  }
  std::vector<bool> keep(turns.size());
  for (size_t i = 0; i < turns.size(); ++i) keep[i] = good[bins[i]];
  return keep;
}

}  // namespace alidade
