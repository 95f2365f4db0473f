#include "alidade/geometry/two_view_ransac.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "alidade/base/parallel.h"
#include "alidade/base/random.h"
#include "alidade/geometry/fundamental.h"
#include "alidade/geometry/homography.h"

namespace alidade {
namespace {

using Points = std::span<const Eigen::Vector2d>;

// Four matches at a time (GCC's and clang's vector type; SSE, NEON or WebAssembly below it).
using Float4 = float __attribute__((vector_size(16)));

Float4 Load(const float* p) {
  Float4 v;
  std::memcpy(&v, p, sizeof(v));
  return v;
}

// Coordinates one array each, padded to whole vectors with NaN, which no comparison takes for an
// inlier.
struct Lanes {
  std::vector<float> ax, ay, bx, by;

  Lanes(Points a, Points b) {
    const size_t padded = (a.size() + 3) / 4 * 4;
    for (std::vector<float>* lane : {&ax, &ay, &bx, &by}) {
      lane->assign(padded, std::numeric_limits<float>::quiet_NaN());
    }
    for (size_t i = 0; i < a.size(); ++i) {
      ax[i] = static_cast<float>(a[i].x());
      ay[i] = static_cast<float>(a[i].y());
      bx[i] = static_cast<float>(b[i].x());
      by[i] = static_cast<float>(b[i].y());
    }
  }
  size_t size() const { return ax.size(); }
};

// rho of eq. 2: what a squared distance below the bound adds to the score; the same maximum for
// both models.
Float4 Gain(Float4 squared, float bound) {
  const Float4 zero = {};
  return squared < bound ? static_cast<float>(kChi2Homography) - squared : zero;
}

double Sum(Float4 v) { return static_cast<double>((v[0] + v[1]) + (v[2] + v[3])); }

struct Homography {
  static constexpr float kBound = static_cast<float>(kChi2Homography);
  Eigen::Matrix3f forward, backward;

  explicit Homography(const Eigen::Matrix3d& H) : forward(H.cast<float>()) {
    backward = H.inverse().cast<float>();
  }
  static Eigen::Matrix3d Estimate(Points a, Points b) { return EstimateHomography(a, b); }

  static Float4 Transfer(const Eigen::Matrix3f& H, Float4 x, Float4 y, Float4 u, Float4 v) {
    const Float4 w = 1.0f / (H(2, 0) * x + H(2, 1) * y + H(2, 2));
    const Float4 du = (H(0, 0) * x + H(0, 1) * y + H(0, 2)) * w - u;
    const Float4 dv = (H(1, 0) * x + H(1, 1) * y + H(1, 2)) * w - v;
    return du * du + dv * dv;
  }
  // Squared distances in b and in a.
  std::array<Float4, 2> Distances(Float4 ax, Float4 ay, Float4 bx, Float4 by) const {
    return {Transfer(forward, ax, ay, bx, by), Transfer(backward, bx, by, ax, ay)};
  }
};

struct Fundamental {
  static constexpr float kBound = static_cast<float>(kChi2Fundamental);
  Eigen::Matrix3f F;

  explicit Fundamental(const Eigen::Matrix3d& matrix) : F(matrix.cast<float>()) {}
  static Eigen::Matrix3d Estimate(Points a, Points b) { return EstimateFundamental(a, b); }

  std::array<Float4, 2> Distances(Float4 ax, Float4 ay, Float4 bx, Float4 by) const {
    const Float4 lb0 = F(0, 0) * ax + F(0, 1) * ay + F(0, 2);  // line in b
    const Float4 lb1 = F(1, 0) * ax + F(1, 1) * ay + F(1, 2);
    const Float4 lb2 = F(2, 0) * ax + F(2, 1) * ay + F(2, 2);
    const Float4 la0 = F(0, 0) * bx + F(1, 0) * by + F(2, 0);  // line in a
    const Float4 la1 = F(0, 1) * bx + F(1, 1) * by + F(2, 1);
    const Float4 product = lb0 * bx + lb1 * by + lb2;
    const Float4 squared = product * product;
    return {squared / (lb0 * lb0 + lb1 * lb1), squared / (la0 * la0 + la1 * la1)};
  }
};

template <typename Model>
double Score(const Eigen::Matrix3d& matrix, const Lanes& lanes) {
  const Model model(matrix);
  Float4 score = {};
  for (size_t i = 0; i < lanes.size(); i += 4) {
    const std::array<Float4, 2> squared = model.Distances(Load(&lanes.ax[i]), Load(&lanes.ay[i]),
                                                          Load(&lanes.bx[i]), Load(&lanes.by[i]));
    score += Gain(squared[0], Model::kBound) + Gain(squared[1], Model::kBound);
  }
  return Sum(score);
}

template <typename Model>
void MarkInliers(const Lanes& lanes, size_t count, RansacModel& fitted) {
  const Model model(fitted.matrix);
  fitted.inlier.assign(count, false);
  fitted.inliers = 0;
  for (size_t i = 0; i < lanes.size(); i += 4) {
    const std::array<Float4, 2> squared = model.Distances(Load(&lanes.ax[i]), Load(&lanes.ay[i]),
                                                          Load(&lanes.bx[i]), Load(&lanes.by[i]));
    for (size_t k = 0; k < 4 && i + k < count; ++k) {
      const bool inside = squared[0][k] < Model::kBound && squared[1][k] < Model::kBound;
      fitted.inlier[i + k] = inside;
      fitted.inliers += inside;
    }
  }
}

// Estimates again from the inliers while it helps: a sample of eight carries the noise of eight.
template <typename Model>
RansacModel Polish(RansacModel fitted, const Lanes& lanes, Points a, Points b) {
  std::vector<Eigen::Vector2d> inliers_a, inliers_b;
  for (int round = 0; round < 5; ++round) {
    MarkInliers<Model>(lanes, a.size(), fitted);
    if (fitted.inliers < 8) break;
    inliers_a.clear();
    inliers_b.clear();
    for (size_t i = 0; i < a.size(); ++i) {
      if (!fitted.inlier[i]) continue;
      inliers_a.push_back(a[i]);
      inliers_b.push_back(b[i]);
    }
    const Eigen::Matrix3d matrix = Model::Estimate(inliers_a, inliers_b);
    const double score = Score<Model>(matrix, lanes);
    if (!(score > fitted.score)) break;
    fitted.matrix = matrix;
    fitted.score = score;
  }
  return fitted;
}

struct Sample {
  std::array<Eigen::Vector2d, 8> a, b;
};

struct Candidate {
  Eigen::Matrix3d matrix;
  double score = 0;
};

template <typename Model>
Candidate Try(const Sample& sample, const Lanes& lanes) {
  Candidate candidate;
  candidate.matrix = Model::Estimate(sample.a, sample.b);
  candidate.score = Score<Model>(candidate.matrix, lanes);
  return candidate;
}

template <typename Model>
RansacModel Best(const std::vector<Candidate>& candidates, const Lanes& lanes, Points a, Points b) {
  RansacModel best;
  for (const Candidate& candidate : candidates) {  // in order: the first of equals wins
    if (candidate.score > best.score) {
      best.score = candidate.score;
      best.matrix = candidate.matrix;
    }
  }
  return best.score > 0 ? Polish<Model>(best, lanes, a, b) : best;
}

}  // namespace

RansacModels FitTwoViewModels(Points a, Points b, int iterations, uint64_t seed, bool parallel) {
  Random random(seed);
  std::vector<Sample> samples(iterations);
  for (Sample& sample : samples) {
    const std::vector<int> chosen = random.Sample(8, static_cast<int>(a.size()));
    for (int k = 0; k < 8; ++k) {
      sample.a[k] = a[chosen[k]];
      sample.b[k] = b[chosen[k]];
    }
  }

  const Lanes lanes(a, b);
  std::vector<Candidate> homographies(iterations), fundamentals(iterations);
  constexpr int kChunk = 10;  // samples; about 20 microseconds of work
  const int chunks = (iterations + kChunk - 1) / kChunk;
  const auto try_chunk = [&](int chunk) {
    for (int i = chunk * kChunk; i < std::min((chunk + 1) * kChunk, iterations); ++i) {
      homographies[i] = Try<Homography>(samples[i], lanes);
      fundamentals[i] = Try<Fundamental>(samples[i], lanes);
    }
  };
  if (parallel) {
    ParallelFor(chunks, try_chunk);
  } else {
    for (int chunk = 0; chunk < chunks; ++chunk) try_chunk(chunk);
  }
  return {Best<Homography>(homographies, lanes, a, b),
          Best<Fundamental>(fundamentals, lanes, a, b)};
}

}  // namespace alidade
