// Descriptor matching: brute force with ratio test and cross-check, and windowed search.
#pragma once

#include <span>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/features/descriptor.h"
#include "alidade/features/frame.h"

namespace ALIDADE_API alidade {

struct MatchSettings {
  int max_distance = 50;    // bits of 256
  double ratio = 0.7;       // best must be below this share of the second best (Lowe 2004); 1 = off
  bool cross_check = true;  // the best in both directions
  bool check_orientation =
      true;  // keep the three best-filled of 30 bins of angle difference (ORB-SLAM)
};

struct IndexMatch {
  int a = -1, b = -1;  // indices into the two frames
  int distance = 0;    // Hamming distance, bits
};

// Matches all against all; the result is sorted by a. O(|a|·|b|): 1000 x 1000 takes a few
// milliseconds.
std::vector<IndexMatch> MatchBruteForce(const Frame& a, const Frame& b,
                                        const MatchSettings& settings = {});
// The same for the listed keypoint indices only.
std::vector<IndexMatch> MatchSubsets(const Frame& a, std::span<const int> of_a, const Frame& b,
                                     std::span<const int> of_b, const MatchSettings& settings = {});

// Searches each keypoint of `a` in `b` within `radius` pixels (along each axis) of `guess` (one per
// keypoint of a; initially its own position), at most one pyramid level up or down. For monocular
// initialization, where no pose is known.
std::vector<IndexMatch> MatchWindow(const Frame& a, const Frame& b,
                                    std::span<const Eigen::Vector2f> guess, float radius,
                                    const MatchSettings& settings = {});

// Flags matches whose patch rotation agrees with the majority (true = keep). `turns`: angle_a -
// angle_b per match, radians.
std::vector<bool> ConsistentTurns(std::span<const float> turns);

}  // namespace alidade
