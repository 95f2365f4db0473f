#include "alidade/optimize/bundle_linearise.h"

#include <cmath>

#include "alidade/base/parallel.h"

namespace alidade {
namespace {

inline void Accumulate(const Symmetric3& N, const std::array<double, 3>& Y,
                       const std::array<double, 3>& g, CameraBlock& block) {
  const double x = Y[0], y = Y[1], z = Y[2];
  for (int i = 0; i < 6; ++i) block.tt[i] += N[i];
  // C = [Y]x N
  const double c00 = y * N[2] - z * N[1], c01 = y * N[4] - z * N[3], c02 = y * N[5] - z * N[4];
  const double c10 = z * N[0] - x * N[2], c11 = z * N[1] - x * N[4], c12 = z * N[2] - x * N[5];
  const double c20 = x * N[1] - y * N[0], c21 = x * N[3] - y * N[1], c22 = x * N[4] - y * N[2];
  block.rt[0] += c00;
  block.rt[1] += c01;
  block.rt[2] += c02;
  block.rt[3] += c10;
  block.rt[4] += c11;
  block.rt[5] += c12;
  block.rt[6] += c20;
  block.rt[7] += c21;
  block.rt[8] += c22;
  // C [Y]x'
  block.rr[0] += y * c02 - z * c01;
  block.rr[1] += z * c00 - x * c02;
  block.rr[2] += x * c01 - y * c00;
  block.rr[3] += z * c10 - x * c12;
  block.rr[4] += x * c11 - y * c10;
  block.rr[5] += x * c21 - y * c20;
  block.g[0] += g[0];
  block.g[1] += g[1];
  block.g[2] += g[2];
  block.g[3] += y * g[2] - z * g[1];
  block.g[4] += z * g[0] - x * g[2];
  block.g[5] += x * g[1] - y * g[0];
}

bool InFront(const BundleLayout& layout, const BundleState& state, const BundlePoint& point,
             const Eigen::Vector3d& X) {
  for (int i = point.begin; i < point.end; ++i) {
    const BundleCamera& camera = state.cameras[layout.sightings[i].camera];
    if (!(camera.R.row(2).dot(X - camera.centre) > kMinDepth)) return false;
  }
  return true;
}

struct ChunkSums {
  std::vector<CameraBlock> cameras;
  double cost = 0;
  bool valid = true;
};

}  // namespace

void CameraBlock::Add(const CameraBlock& other) {
  for (int i = 0; i < 6; ++i) tt[i] += other.tt[i];
  for (int i = 0; i < 9; ++i) rt[i] += other.rt[i];
  for (int i = 0; i < 6; ++i) rr[i] += other.rr[i];
  for (int i = 0; i < 6; ++i) g[i] += other.g[i];
}

SightingTerms Linearise(const Intrinsics& k, const BundleCamera& camera,
                        const std::array<double, 3>& Y, const BundleSighting& s) {
  const Eigen::Matrix3d& R = camera.R;
  const double x = R(0, 0) * Y[0] + R(0, 1) * Y[1] + R(0, 2) * Y[2];
  const double y = R(1, 0) * Y[0] + R(1, 1) * Y[1] + R(1, 2) * Y[2];
  const double z = R(2, 0) * Y[0] + R(2, 1) * Y[1] + R(2, 2) * Y[2];
  SightingTerms terms;
  terms.in_front = z > kMinDepth;
  const Reprojection<double> e = Reproject<double>(k, x, y, z, s.u, s.v, s.right);
  const double chi2 = s.weight * (e.u * e.u + e.v * e.v) + s.weight_r * (e.right * e.right);
  double w = s.weight, wr = s.weight_r;
  terms.cost = 0.5 * chi2;
  if (chi2 > s.huber * s.huber) {
    const double root = std::sqrt(chi2);
    terms.cost = s.huber * (root - 0.5 * s.huber);
    w *= s.huber / root;
    wr *= s.huber / root;
  }
  // Rows of B = A R.
  double U[3], V[3], S[3];
  for (int i = 0; i < 3; ++i) {
    U[i] = e.u_x * R(0, i) + e.u_z * R(2, i);
    V[i] = e.v_y * R(1, i) + e.v_z * R(2, i);
    S[i] = e.u_x * R(0, i) + e.right_z * R(2, i);
  }
  for (int i = 0, at = 0; i < 3; ++i) {
    const double u = w * U[i], v = w * V[i], r = wr * S[i];
    terms.g[i] = u * e.u + v * e.v + r * e.right;
    for (int j = i; j < 3; ++j) terms.N[at++] = u * U[j] + v * V[j] + r * S[j];
  }
  return terms;
}

void Linearise(const BundleLayout& layout, const BundleState* before, BundleState& state,
               Linearisation& result) {
  result.couplings.resize(layout.couplings);
  result.points.resize(layout.points.size());
  const size_t cameras = layout.free_cameras.size();
  std::vector<ChunkSums> sums(layout.chunk_count());
  ParallelFor(layout.chunk_count(), [&](int chunk) {
    ChunkSums& sum = sums[chunk];
    sum.cameras.resize(cameras);
    for (int j = layout.chunks[chunk]; j < layout.chunks[chunk + 1]; ++j) {
      const BundlePoint& point = layout.points[j];
      if (!InFront(layout, state, point, state.points[j])) {
        if (before) state.points[j] = before->points[j];
        if (!before || !InFront(layout, state, point, state.points[j])) {
          sum.valid = false;
          return;
        }
      }
      const Eigen::Vector3d X = state.points[j];
      PointBlock block{};
      Coupling* coupling = result.couplings.data() + point.coupling;
      for (int i = point.begin; i < point.end; ++i) {
        const BundleSighting& sighting = layout.sightings[i];
        const BundleCamera& camera = state.cameras[sighting.camera];
        const std::array<double, 3> Y{X[0] - camera.centre[0], X[1] - camera.centre[1],
                                      X[2] - camera.centre[2]};
        const SightingTerms terms = Linearise(layout.intrinsics, camera, Y, sighting);
        sum.cost += terms.cost;
        for (int d = 0; d < 6; ++d) block.H[d] += terms.N[d];
        for (int d = 0; d < 3; ++d) block.g[d] += terms.g[d];
        if (i >= point.free_end) continue;
        *coupling++ = {terms.N, Y, sighting.slot};
        Accumulate(terms.N, Y, terms.g, sum.cameras[sighting.slot]);
      }
      result.points[j] = block;
    }
  });
  result.cameras.assign(cameras, CameraBlock{});
  result.cost = 0;
  result.valid = true;
  for (const ChunkSums& sum : sums) {
    result.valid &= sum.valid;
    result.cost += sum.cost;
    for (size_t c = 0; c < cameras; ++c) result.cameras[c].Add(sum.cameras[c]);
  }
  result.valid &= std::isfinite(result.cost);
}

}  // namespace alidade
