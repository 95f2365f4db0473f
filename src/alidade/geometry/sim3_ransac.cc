#include "alidade/geometry/sim3_ransac.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "alidade/base/error.h"
#include "alidade/base/random.h"
#include "alidade/geometry/alignment.h"
#include "alidade/geometry/samples_needed.h"

namespace alidade {
namespace {

struct Match {
  Eigen::Vector3d p_a, p_b;
  Eigen::Vector2d pixel_a, pixel_b;
  double inverse_a, inverse_b;  // 1 / largest squared error, 1/px²
  size_t index;                 // in the caller's array
};

// Squared error divided by the largest allowed one; infinity behind the camera.
double SquaredShare(const Camera& camera, const Eigen::Vector3d& p, const Eigen::Vector2d& pixel,
                    double inverse) {
  return p.z() > 0 ? (camera.Project(p) - pixel).squaredNorm() * inverse : INFINITY;
}

// 1 for a perfect match, falling to 0 at the largest allowed error in either image.
double Gain(const Camera& camera, const Sim3& T_a_b, const Sim3& T_b_a, const Match& m) {
  const double a = SquaredShare(camera, T_a_b * m.p_b, m.pixel_a, m.inverse_a);
  if (!(a < 1)) return 0;
  const double b = SquaredShare(camera, T_b_a * m.p_a, m.pixel_b, m.inverse_b);
  return b < 1 ? 1 - 0.5 * (a + b) : 0;
}

struct Scored {
  Sim3 T_a_b;
  double score = 0;  // MSAC score (Torr & Zisserman 2000)
  int inliers = 0;
};

Scored Score(const Camera& camera, const Sim3& T_a_b, std::span<const Match> matches) {
  Scored scored{T_a_b};
  const Sim3 T_b_a = T_a_b.Inverse();
  for (const Match& match : matches) {
    const double gain = Gain(camera, T_a_b, T_b_a, match);
    scored.score += gain;
    scored.inliers += gain > 0;
  }
  return scored;
}

// True if three points are not collinear: the triangle's height is at least 1/50 of its longest
// side.
bool SpanPlane(const std::vector<Eigen::Vector3d>& p) {
  const Eigen::Vector3d u = p[1] - p[0], v = p[2] - p[0];
  const double longest = std::max({u.squaredNorm(), v.squaredNorm(), (u - v).squaredNorm()});
  return u.cross(v).norm() > 0.02 * longest;
}

// AlignPoints() that returns false where it has no solution. That happens when the inliers all
// coincide or are unrelated.
bool Align(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b,
           bool with_scale, Sim3& T_a_b) {
  try {
    T_a_b = AlignPoints(a, b, with_scale);
    return T_a_b.t.allFinite() && std::isfinite(T_a_b.s);
  } catch (const Error&) {
    return false;
  }
}

std::vector<Match> Usable(std::span<const Sim3Match> matches, double max_error) {
  std::vector<Match> usable;
  for (size_t i = 0; i < matches.size(); ++i) {
    const Sim3Match& m = matches[i];
    const double a = max_error * m.sigma_a, b = max_error * m.sigma_b;
    if (!m.p_a.allFinite() || !m.p_b.allFinite() || !m.pixel_a.allFinite() ||
        !m.pixel_b.allFinite() || !(a > 0) || !(b > 0)) {
      continue;
    }
    usable.push_back({m.p_a, m.p_b, m.pixel_a, m.pixel_b, 1 / (a * a), 1 / (b * b), i});
  }
  return usable;
}

// Local optimization: re-estimates the transform from all its inliers.
Scored Polish(const Camera& camera, Scored best, std::span<const Match> matches, bool with_scale) {
  for (int round = 0; round < 3; ++round) {
    std::vector<Eigen::Vector3d> a, b;
    const Sim3 T_b_a = best.T_a_b.Inverse();
    for (const Match& m : matches) {
      if (Gain(camera, best.T_a_b, T_b_a, m) <= 0) continue;
      a.push_back(m.p_a);
      b.push_back(m.p_b);
    }
    Sim3 T_a_b;
    if (a.size() < 3 || !Align(a, b, with_scale, T_a_b)) break;
    const Scored scored = Score(camera, T_a_b, matches);
    if (scored.score <= best.score) break;
    best = scored;
  }
  return best;
}

}  // namespace

void Sim3RansacSettings::Check() const {
  const auto require = [](bool holds, const char* what) {
    if (!holds) ThrowUsage(std::string("sim3 ransac settings: ") + what);
  };
  require(max_iterations > 0, "max_iterations must be positive");
  require(max_error > 0 && std::isfinite(max_error), "max_error must be positive");
  require(confidence > 0 && confidence < 1, "confidence must lie between 0 and 1");
  require(min_inliers >= 3, "min_inliers must be at least 3");
}

Sim3RansacResult SolveSim3Ransac(const Camera& camera, std::span<const Sim3Match> matches,
                                 const Sim3RansacSettings& settings) {
  settings.Check();
  Sim3RansacResult result;
  result.inlier.assign(matches.size(), false);
  const std::vector<Match> usable = Usable(matches, settings.max_error);
  const int count = static_cast<int>(usable.size());
  if (count < settings.min_inliers) return result;

  Random random(settings.seed);
  Scored best;
  double needed = settings.max_iterations;
  std::vector<Eigen::Vector3d> a(3), b(3);
  for (int iteration = 0; iteration < settings.max_iterations && iteration < needed; ++iteration) {
    const std::vector<int> sample = random.Sample(3, count);
    for (int k = 0; k < 3; ++k) {
      a[k] = usable[sample[k]].p_a;
      b[k] = usable[sample[k]].p_b;
    }
    Sim3 T_a_b;
    if (!SpanPlane(a) || !SpanPlane(b) || !Align(a, b, settings.with_scale, T_a_b)) continue;
    const Scored scored = Score(camera, T_a_b, usable);
    if (scored.score <= best.score) continue;
    best = Polish(camera, scored, usable, settings.with_scale);
    needed = SamplesNeeded(static_cast<double>(best.inliers) / count, settings.confidence);
  }
  if (best.score <= 0) return result;
  result.T_a_b = best.T_a_b;
  result.inliers = best.inliers;
  const Sim3 T_b_a = best.T_a_b.Inverse();
  for (const Match& m : usable) {
    result.inlier[m.index] = Gain(camera, best.T_a_b, T_b_a, m) > 0;
  }
  result.success = result.inliers >= settings.min_inliers;
  return result;
}

}  // namespace alidade
