#include "alidade/geometry/motion_ranking.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "alidade/geometry/homography.h"

namespace alidade {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
// Widening of the first chi² bound for refinement from a distant start: about 20 pixels, the image
// motion of a rotation by 2 degrees.
constexpr double kFarStart = 100;
// Cosine of 20 degrees: a motion found from another direction counts as a different solution beyond
// this angle to the best one, or if its score is higher.
constexpr double kNear = 0.94;

// Motions this close are the same solution.
bool SameMotion(const Se3& x, const Se3& y) {
  return RotationAngle(x, y) < 1.5 * kDegree && x.t.dot(y.t) > std::cos(6 * kDegree);
}

void SortByScore(std::vector<RankedMotion>& hypotheses) {
  std::stable_sort(
      hypotheses.begin(), hypotheses.end(),
      [](const RankedMotion& x, const RankedMotion& y) { return x.score.score > y.score.score; });
}

// Adds the motion refined from `start`. If the refinement moved far away, also adds the start
// itself: in a flat valley between two solutions the minimum is poorly determined, and the start
// may be as good.
void Add(const Se3& start, const RayPairs& rays, std::vector<RankedMotion>& hypotheses) {
  const auto known = [&](const Se3& T_b_a, bool refined_only) {
    return std::any_of(hypotheses.begin(), hypotheses.end(), [&](const RankedMotion& other) {
      return !(refined_only && other.unrefined) && SameMotion(other.T_b_a, T_b_a);
    });
  };
  const RefinedMotion refined = RefineMotion(start, rays);
  if (!known(refined.T_b_a, true)) {
    hypotheses.push_back({refined.T_b_a, ScoreMotion(refined.T_b_a, rays), refined.direction_sigma,
                          refined.noise, false});
  }
  if (!known(start, false)) {
    hypotheses.push_back(
        {start, ScoreMotion(start, rays), refined.direction_sigma, refined.noise, true});
  }
}

// Two views of a plane always admit two motions. Returns the motions of the plane that best fits
// the points placed by `hypothesis`; if they explain the matches as well, the scene is too flat to
// decide.
std::vector<Se3> PlanarTwins(const RankedMotion& hypothesis, const RayPairs& rays) {
  // A plane n' p = 1 has inverse depth n' a along the ray a: linear in n, with errors of equal
  // size.
  const Se3& T = hypothesis.T_b_a;
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < rays.size(); ++i) {
    if (!(hypothesis.score.gain[i] > 0)) continue;
    // b ~ R a + t / depth gives one equation per coordinate of b; least squares over both.
    const Eigen::Vector3d turned = T.R * rays.a[i];
    const Eigen::Vector2d offset = turned.head<2>() - turned.z() * rays.b[i].head<2>();
    const Eigen::Vector2d slope = T.t.z() * rays.b[i].head<2>() - T.t.head<2>();
    H += slope.squaredNorm() * rays.a[i] * rays.a[i].transpose();
    g += slope.dot(offset) * rays.a[i];
  }
  const Eigen::Vector3d n = H.ldlt().solve(g);
  return MotionsFromHomography(T.R + T.t * n.transpose());
}

}  // namespace

std::vector<RankedMotion> RankMotions(const std::vector<Se3>& motions, const RayPairs& rays) {
  std::vector<RankedMotion> rough;
  double most = 0;
  // A bound of three times the distance, since these motions carry the noise of the models they
  // were derived from.
  for (const Se3& T_b_a : motions) {
    rough.push_back({T_b_a, ScoreMotion(T_b_a, rays, 9), 0, 1, true});
    most = std::max(most, rough.back().score.score);
  }
  SortByScore(rough);
  std::vector<RankedMotion> ranked;
  for (const RankedMotion& start : rough) {
    if (start.score.score < 0.6 * most || most == 0) break;
    Add(start.T_b_a, rays, ranked);
  }
  SortByScore(ranked);
  // Twice: if the twin becomes the best motion, it is tested against its own twin.
  for (int round = 0; round < 2 && !ranked.empty(); ++round) {
    for (const Se3& twin : PlanarTwins(ranked.front(), rays)) {
      if (ScoreMotion(twin, rays, 9).good < 0.5 * ranked.front().score.good) continue;
      Add(twin, rays, ranked);
    }
    SortByScore(ranked);
  }
  return ranked;
}

std::vector<RankedMotion> AddOtherDirections(std::vector<RankedMotion> ranked, const RayPairs& rays,
                                             double min_placed_share) {
  if (ranked.empty()) return ranked;
  const Se3 best = ranked.front().T_b_a;
  const double needed = 0.5 * ranked.front().score.score;
  // 13 of the 26 directions: the Sampson distance is the same for a direction and its opposite.
  for (int code = 14; code < 27; ++code) {
    const Eigen::Vector3d direction(code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1);
    const RefinedMotion refined = RefineMotion({best.R, direction.normalized()}, rays, kFarStart);
    for (const double sign : {1.0, -1.0}) {
      const Se3 T_b_a{refined.T_b_a.R, sign * refined.T_b_a.t};
      RankedMotion found{T_b_a, ScoreMotion(T_b_a, rays), refined.direction_sigma, refined.noise,
                         false};
      const bool known = std::any_of(ranked.begin(), ranked.end(), [&](const RankedMotion& other) {
        return !other.unrefined && SameMotion(other.T_b_a, T_b_a);
      });
      // Refinement can stop anywhere in a flat valley; bundle adjustment corrects a direction this
      // close.
      if (found.score.score <= ranked.front().score.score && T_b_a.t.dot(best.t) > kNear) continue;
      if (found.score.placed < min_placed_share * found.score.good) continue;
      if (!known && found.score.score > needed) ranked.push_back(std::move(found));
    }
  }
  SortByScore(ranked);
  return ranked;
}

bool IsRival(const RankedMotion& best, const RankedMotion& other, double max_share) {
  if (other.score.good <= max_share * best.score.good) return false;
  double lost = 0, squares = 0;
  for (size_t i = 0; i < best.score.gain.size(); ++i) {
    const double difference = best.score.gain[i] - other.score.gain[i];
    lost += difference;
    squares += difference * difference;
  }
  // In the same valley: within the 99.99 % confidence region (chi² with 5 degrees of freedom).
  if (other.unrefined) return lost < 26;
  // A separate solution. If neither explains more, the sum of differences has standard deviation
  // sqrt(squares). The threshold is a compromise: a lower one accepts wrong directions; a higher
  // one (5) delays the start in scenes with little texture until worse pairs are accepted.
  return lost < 3.5 * std::sqrt(squares) || lost < 0.04 * best.score.score;
}

}  // namespace alidade
