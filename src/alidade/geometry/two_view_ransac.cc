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

// Four matches at a time: a vector type of GCC and clang, compiled to SSE, NEON or WebAssembly
// SIMD.
using Float4 = float __attribute__((vector_size(16)));

Float4 Load(const float* p) {
  Float4 v;
  std::memcpy(&v, p, sizeof(v));
  return v;
}

// One array per coordinate, padded to whole vectors with NaN, which fails every inlier comparison.
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

// rho of eq. 2: contribution of a squared distance below the bound; both models have the same
// maximum.
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
void MarkInliers(const Lanes& lanes, size_t count, float widening, RansacModel& fitted) {
  const float bound = widening * Model::kBound;
  const Model model(fitted.matrix);
  fitted.inlier.assign(count, false);
  fitted.inliers = 0;
  for (size_t i = 0; i < lanes.size(); i += 4) {
    const std::array<Float4, 2> squared = model.Distances(Load(&lanes.ax[i]), Load(&lanes.ay[i]),
                                                          Load(&lanes.bx[i]), Load(&lanes.by[i]));
    for (size_t k = 0; k < 4 && i + k < count; ++k) {
      const bool inside = squared[0][k] < bound && squared[1][k] < bound;
      fitted.inlier[i + k] = inside;
      fitted.inliers += inside;
    }
  }
}

std::vector<Eigen::Vector2d> Chosen(Points points, const std::vector<bool>& chosen) {
  std::vector<Eigen::Vector2d> result;
  for (size_t i = 0; i < points.size(); ++i) {
    if (chosen[i]) result.push_back(points[i]);
  }
  return result;
}

// Re-estimates from the inliers, at first of a wider bound: the model of a sample of eight is noisy
// but passes near most of the inliers it misses (local optimization, Chum, Matas & Kittler 2003).
template <typename Model>
RansacModel Polish(const RansacModel& start, const Lanes& lanes, Points a, Points b) {
  RansacModel best = start, current = start;
  for (const float widening : {9.f, 4.f, 1.f, 1.f, 1.f}) {
    MarkInliers<Model>(lanes, a.size(), widening, current);
    if (current.inliers < 8) break;
    current.matrix = Model::Estimate(Chosen(a, current.inlier), Chosen(b, current.inlier));
    current.score = Score<Model>(current.matrix, lanes);
    if (current.score > best.score) {
      best = current;
    } else if (widening == 1.f) {
      break;
    }
  }
  MarkInliers<Model>(lanes, a.size(), 1, best);
  return best;
}

struct Sample {
  std::array<Eigen::Vector2d, 8> a, b;
};

struct Candidate {
  Eigen::Matrix3d matrix;
  double score = 0;
};

template <typename Model>
Candidate Try(Points a, Points b, const Lanes& lanes) {
  Candidate candidate;
  candidate.matrix = Model::Estimate(a, b);
  candidate.score = Score<Model>(candidate.matrix, lanes);
  return candidate;
}

// The best few candidates to polish; with many outliers the top one is often not the one that
// polishes best.
std::vector<Candidate> MostPromising(std::vector<Candidate> candidates) {
  // Stable sort: the first of equal scores wins.
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& x, const Candidate& y) { return x.score > y.score; });
  if (candidates.size() > 5) candidates.resize(5);
  return candidates;
}

template <typename Model>
RansacModel Best(const std::vector<Candidate>& candidates, const Lanes& lanes, Points a, Points b) {
  RansacModel best;
  best.inlier.assign(a.size(), false);
  for (const Candidate& candidate : candidates) {
    if (!(candidate.score > 0)) continue;
    RansacModel start;
    start.matrix = candidate.matrix;
    start.score = candidate.score;
    RansacModel polished = Polish<Model>(start, lanes, a, b);
    if (polished.score > best.score) best = std::move(polished);
  }
  return best;
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
  constexpr int kChunk = 10;  // samples per task; about 20 µs of work
  const int chunks = (iterations + kChunk - 1) / kChunk;
  const auto try_chunk = [&](int chunk) {
    for (int i = chunk * kChunk; i < std::min((chunk + 1) * kChunk, iterations); ++i) {
      homographies[i] = Try<Homography>(samples[i].a, samples[i].b, lanes);
      fundamentals[i] = Try<Fundamental>(samples[i].a, samples[i].b, lanes);
    }
  };
  if (parallel) {
    ParallelFor(chunks, try_chunk);
  } else {
    for (int chunk = 0; chunk < chunks; ++chunk) try_chunk(chunk);
  }
  RansacModels models;
  models.fundamental = Best<Fundamental>(MostPromising(std::move(fundamentals)), lanes, a, b);
  homographies = MostPromising(std::move(homographies));
  // The inliers of the fundamental matrix contain the matches of a plane with few outliers. This
  // gives a start where outliers are too many for samples of eight.
  if (models.fundamental.inliers >= 8) {
    homographies.push_back(Try<Homography>(Chosen(a, models.fundamental.inlier),
                                           Chosen(b, models.fundamental.inlier), lanes));
  }
  models.homography = Best<Homography>(homographies, lanes, a, b);
  return models;
}

}  // namespace alidade
