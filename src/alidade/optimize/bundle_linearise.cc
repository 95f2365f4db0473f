#include "alidade/optimize/bundle_linearise.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "alidade/base/parallel.h"
#include "alidade/optimize/sighting_terms.h"

namespace alidade {
namespace {

static_assert(offsetof(BundleSighting, trust) ==
              offsetof(BundleSighting, u) + 7 * sizeof(double));  // read as eight numbers
static_assert(sizeof(BundleCamera) == 12 * sizeof(double));
static_assert(sizeof(SightingTerms) == 32 * sizeof(double));

// Sightings that are evaluated together: few enough that their terms stay in the cache.
constexpr int kSightingsTogether = 64;

struct ChunkSums {
  std::vector<CameraBlock> cameras;
  double cost = 0;
  bool valid = true;
};

inline Double2 PairOf(const double* numbers) { return Double2{numbers[0], numbers[1]}; }

inline void Add(const SightingTerms& terms, CameraBlock& camera) {
#pragma GCC unroll 14
  for (int i = 0; i < 14; ++i) camera.sums[i] += PairOf(terms.camera + 2 * i);
}

// Sums of the sightings of a point with even or with odd index, added at the end.
struct PointSums {
  Double2 N[3]{}, g[2]{}, cost{};  // the first of `g` is another number

  void Add(const SightingTerms& terms) {
    for (int i = 0; i < 3; ++i) N[i] += PairOf(terms.camera + CameraBlock::kTt + 2 * i);
    for (int i = 0; i < 2; ++i) g[i] += PairOf(terms.camera + CameraBlock::kG - 1 + 2 * i);
    AddCost(terms);
  }
  void AddCost(const SightingTerms& terms) { cost += Double2{terms.cost, 0}; }
};

class Worker {
 public:
  Worker(const BundleLayout& layout, const BundleState* before, BundleState& state,
         Linearisation& result, ChunkSums& sums, bool derivatives)
      : layout_(layout),
        before_(before),
        state_(state),
        result_(result),
        sums_(sums),
        derivatives_(derivatives) {
    sums.cameras.resize(layout.free_cameras.size());
  }

  // Points [begin, end). Returns false where one stays behind a camera.
  bool Add(int begin, int end) {
    while (begin < end) {
      int after = begin + 1;
      while (after < end &&
             layout_.points[after].end - layout_.points[begin].begin <= kSightingsTogether)
        ++after;
      Evaluate(begin, after, terms_);
      const int first = layout_.points[begin].begin;
      for (; begin < after; ++begin) {
        const SightingTerms* terms = terms_.data() + (layout_.points[begin].begin - first);
        if (IsBehind(begin, terms)) {
          if (!before_) return false;
          state_.points[begin] = before_->points[begin];
          Evaluate(begin, begin + 1, of_one_);
          terms = of_one_.data();
          if (IsBehind(begin, terms)) return false;
        }
        AddPoint(begin, terms);
      }
    }
    return true;
  }

 private:
  void Evaluate(int begin, int end, std::vector<SightingTerms>& terms) {
    places_.clear();
    for (int j = begin; j < end; ++j) {
      const BundlePoint& point = layout_.points[j];
      for (int i = point.begin; i < point.end; ++i) {
        const BundleSighting& sighting = layout_.sightings[i];
        places_.push_back(
            {&sighting.u, state_.cameras[sighting.camera].R.data(), state_.points[j].data()});
      }
    }
    const size_t count = places_.size();
    while (places_.size() % kSightingGroup != 0) places_.push_back(places_.back());
    if (terms.size() < places_.size()) terms.resize(places_.size());
    const Intrinsics& k = layout_.intrinsics;
    evaluate_({k.fx, k.fy, k.cx, k.cy, k.bf}, places_.data(), static_cast<int>(count), derivatives_,
              terms.data());
  }

  bool IsBehind(int j, const SightingTerms* terms) const {
    const BundlePoint& point = layout_.points[j];
    return std::any_of(terms, terms + (point.end - point.begin), [](const SightingTerms& t) {
      return t.cost == std::numeric_limits<double>::infinity();
    });
  }

  void AddPoint(int j, const SightingTerms* terms) {
    const BundlePoint& point = layout_.points[j];
    PointSums sums[2];
    if (!derivatives_) {
      for (int i = point.begin; i < point.end; ++i)
        sums[(i - point.begin) % 2].AddCost(terms[i - point.begin]);
      sums_.cost += sums[0].cost[0] + sums[1].cost[0];
      return;
    }
    Coupling* coupling = result_.couplings.data() + point.coupling;
    for (int i = point.begin; i < point.end; ++i, ++terms) {
      sums[(i - point.begin) % 2].Add(*terms);
      if (i >= point.free_end) continue;
      coupling->slot = layout_.sightings[i].slot;
      alidade::Add(*terms, sums_.cameras[coupling->slot]);
      for (int n = 0; n < 6; ++n) coupling->N[n] = terms->camera[CameraBlock::kTt + n];
      for (int n = 0; n < 3; ++n) coupling->Y[n] = terms->Y[n];
      ++coupling;
    }
    PointBlock& block = result_.points[j];
    for (int i = 0; i < 3; ++i) {
      const Double2 N = sums[0].N[i] + sums[1].N[i];
      block.H[2 * i] = N[0];
      block.H[2 * i + 1] = N[1];
    }
    const Double2 g[2] = {sums[0].g[0] + sums[1].g[0], sums[0].g[1] + sums[1].g[1]};
    block.g = {g[0][1], g[1][0], g[1][1]};
    sums_.cost += sums[0].cost[0] + sums[1].cost[0];
  }

  const BundleLayout& layout_;
  const BundleState* before_;
  BundleState& state_;
  Linearisation& result_;
  ChunkSums& sums_;
  bool derivatives_;
  EvaluateSightings evaluate_ = FastestEvaluateSightings();
  std::vector<SightingPlace> places_;
  std::vector<SightingTerms> terms_, of_one_;
};

}  // namespace

BundleState StartOf(const BundleProblem& problem, const BundleLayout& layout) {
  BundleState state;
  state.cameras.reserve(problem.T_camera_world.size());
  for (const Se3& T : problem.T_camera_world) state.cameras.push_back({T.R, T.Inverse().t});
  state.points.reserve(layout.points.size());
  for (const BundlePoint& p : layout.points) state.points.push_back(problem.points[p.index]);
  state.motion = problem.motion.states;
  return state;
}

Matrix6d CameraBlock::Hessian() const {
  const CameraBlock& b = *this;
  Matrix6d H;
  H.row(0) << b[0], b[1], b[2], b[6], b[9], b[12];
  H.row(1) << b[1], b[3], b[4], b[7], b[10], b[13];
  H.row(2) << b[2], b[4], b[5], b[8], b[11], b[14];
  H.row(3) << b[6], b[7], b[8], b[15], b[16], b[17];
  H.row(4) << b[9], b[10], b[11], b[16], b[18], b[19];
  H.row(5) << b[12], b[13], b[14], b[17], b[19], b[20];
  return H;
}

Vector6d CameraBlock::Gradient() const {
  Vector6d g;
  for (int i = 0; i < 6; ++i) g[i] = (*this)[kG + i];
  return g;
}

void CameraBlock::Add(const Matrix6d& H, const Vector6d& g) {
  const auto add = [&](int i, double value) { sums[i / 2][i % 2] += value; };
  for (int row = 0, tt = kTt, rr = kRr; row < 3; ++row) {
    for (int column = row; column < 3; ++column) {
      add(tt++, H(row, column));
      add(rr++, H(3 + row, 3 + column));
    }
    for (int column = 0; column < 3; ++column) add(kRt + 3 * row + column, H(3 + row, column));
  }
  for (int i = 0; i < 6; ++i) add(kG + i, g[i]);
}

void Linearise(const BundleLayout& layout, const BundleState* before, BundleState& state,
               Linearisation& result, bool derivatives) {
  result.couplings.resize(layout.couplings);
  result.points.resize(layout.points.size());
  std::vector<ChunkSums> sums(layout.chunk_count());
  ParallelFor(layout.chunk_count(), [&](int chunk) {
    Worker worker(layout, before, state, result, sums[chunk], derivatives);
    sums[chunk].valid = worker.Add(layout.chunks[chunk], layout.chunks[chunk + 1]);
  });
  result.cameras = sums[0].cameras;
  result.cost = sums[0].cost;
  result.valid = sums[0].valid;
  for (size_t chunk = 1; chunk < sums.size(); ++chunk) {
    result.valid &= sums[chunk].valid;
    result.cost += sums[chunk].cost;
    for (size_t c = 0; c < result.cameras.size(); ++c) {
      for (size_t i = 0; i < result.cameras[c].sums.size(); ++i) {
        result.cameras[c].sums[i] += sums[chunk].cameras[c].sums[i];
      }
    }
  }
  AddMotion(layout.motion, state, result);
  result.valid &= std::isfinite(result.cost);
}

}  // namespace alidade
