// Matching descriptors: brute force with ratio test and cross check.
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
  int a = -1, b = -1;  // indices into the two sets
  int distance = 0;    // bits
};

// All against all, sorted by a. O(|a|·|b|): 1000 x 1000 takes a few milliseconds.
std::vector<IndexMatch> MatchBruteForce(const Frame& a, const Frame& b,
                                        const MatchSettings& settings = {});
// The same, restricted to the listed keypoints of each.
std::vector<IndexMatch> MatchSubsets(const Frame& a, std::span<const int> of_a, const Frame& b,
                                     std::span<const int> of_b, const MatchSettings& settings = {});

// Keypoints of `a` searched in `b`, one level up or down at most, within `radius` pixels (each
// axis) of `guess` (one for each keypoint of a; the keypoint's own position on the first call): the
// monocular start, where no pose is known.
std::vector<IndexMatch> MatchWindow(const Frame& a, const Frame& b,
                                    std::span<const Eigen::Vector2f> guess, float radius,
                                    const MatchSettings& settings = {});

// Which matches have a turn of the patch unlike the rest: flags true = keep. `turn` = angle_a -
// angle_b, radians.
std::vector<bool> ConsistentTurns(std::span<const float> turns);

}  // namespace alidade
