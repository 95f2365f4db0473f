#include "alidade/optimize/bundle_linearise.h"

#include <cmath>

#include "alidade/base/parallel.h"

namespace alidade {
namespace {

// Terms of two sightings of one point, computed in parallel.
struct Terms {
  Double2 Y[3];  // point minus camera center, world axes
  // B' W B; W contains trust and the loss's weight at this state (iteratively reweighted least
  // squares).
  Double2 N[6];
  Double2 g[3];  // B' W r
  Double2 cost;
  Mask2 in_front;
};

[[gnu::always_inline]] inline Terms Look(const Intrinsics& k, const BundleCamera& c0,
                                         const BundleCamera& c1, const Eigen::Vector3d& X,
                                         const BundleSighting& s0, const BundleSighting& s1,
                                         Double2 counts) {
  Terms t;
  Double2 R[9];
  for (int i = 0; i < 9; ++i) R[i] = Double2{c0.R.data()[i], c1.R.data()[i]};  // column-major
  for (int i = 0; i < 3; ++i) t.Y[i] = X[i] - Double2{c0.centre[i], c1.centre[i]};
  const Double2 x = R[0] * t.Y[0] + R[3] * t.Y[1] + R[6] * t.Y[2];
  const Double2 y = R[1] * t.Y[0] + R[4] * t.Y[1] + R[7] * t.Y[2];
  const Double2 z = R[2] * t.Y[0] + R[5] * t.Y[1] + R[8] * t.Y[2];
  t.in_front = z > kMinDepth;
  const Reprojection<Double2> e = Reproject<Double2>(
      k, x, y, z, Double2{s0.u, s1.u}, Double2{s0.v, s1.v}, Double2{s0.right, s1.right});
  Double2 w = Double2{s0.weight, s1.weight} * counts;
  Double2 wr = Double2{s0.weight_r, s1.weight_r} * counts;
  const Double2 chi2 = w * (e.u * e.u + e.v * e.v) + wr * (e.d * e.d);
  const Double2 huber{s0.huber, s1.huber};
  const Double2 root = Sqrt(chi2), inner = Min(root, huber);
  const Double2 trust{s0.trust, s1.trust};
  // Huber's loss times Geman & McClure's factor; one of the two is always inactive.
  const Double2 q = 1 / (1 + chi2 * Double2{s0.inv_c2, s1.inv_c2});
  t.cost = trust * (inner * (root - 0.5 * inner)) * q;
  const Double2 say = trust * (root > huber ? huber / root : Both(1)) * (q * q);
  w *= say;
  wr *= say;
  // Rows of B = A R, with A the derivative by the point in the camera frame.
  Double2 U[3], V[3], S[3];
  for (int i = 0; i < 3; ++i) {
    U[i] = e.u_x * R[3 * i] + e.u_z * R[3 * i + 2];
    V[i] = e.v_y * R[3 * i + 1] + e.v_z * R[3 * i + 2];
    S[i] = e.d_z * R[3 * i + 2];
  }
  for (int i = 0, at = 0; i < 3; ++i) {
    const Double2 u = w * U[i], v = w * V[i], r = wr * S[i];
    t.g[i] = u * e.u + v * e.v + r * e.d;
    for (int j = i; j < 3; ++j) t.N[at++] = u * U[j] + v * V[j] + r * S[j];
  }
  return t;
}

// Adds G N G' and G g of both sightings to their cameras.
[[gnu::always_inline]] inline void AddToCameras(const Terms& t, CameraBlock& first,
                                                CameraBlock* second) {
  const Double2 x = t.Y[0], y = t.Y[1], z = t.Y[2];
  const Double2* N = t.N;
  Double2 q[28];
  for (int i = 0; i < 6; ++i) q[CameraBlock::kTt + i] = N[i];
  // C = [Y]x N
  Double2* C = q + CameraBlock::kRt;
  C[0] = y * N[2] - z * N[1];
  C[1] = y * N[4] - z * N[3];
  C[2] = y * N[5] - z * N[4];
  C[3] = z * N[0] - x * N[2];
  C[4] = z * N[1] - x * N[4];
  C[5] = z * N[2] - x * N[5];
  C[6] = x * N[1] - y * N[0];
  C[7] = x * N[3] - y * N[1];
  C[8] = x * N[4] - y * N[2];
  // C [Y]x'
  Double2* rr = q + CameraBlock::kRr;
  rr[0] = y * C[2] - z * C[1];
  rr[1] = z * C[0] - x * C[2];
  rr[2] = x * C[1] - y * C[0];
  rr[3] = z * C[3] - x * C[5];
  rr[4] = x * C[4] - y * C[3];
  rr[5] = x * C[7] - y * C[6];
  Double2* g = q + CameraBlock::kG;
  for (int i = 0; i < 3; ++i) g[i] = t.g[i];
  g[3] = y * t.g[2] - z * t.g[1];
  g[4] = z * t.g[0] - x * t.g[2];
  g[5] = x * t.g[1] - y * t.g[0];
  q[CameraBlock::kSize] = Both(0);
  for (int i = 0; i < 14; ++i) first.sums[i] += Double2{q[2 * i][0], q[2 * i + 1][0]};
  if (!second) return;
  for (int i = 0; i < 14; ++i) second->sums[i] += Double2{q[2 * i][1], q[2 * i + 1][1]};
}

inline void StoreCoupling(const Terms& t, int lane, int slot, Coupling& coupling) {
  for (int i = 0; i < 6; ++i) coupling.N[i] = t.N[i][lane];
  for (int i = 0; i < 3; ++i) coupling.Y[i] = t.Y[i][lane];
  coupling.slot = slot;
}

struct ChunkSums {
  std::vector<CameraBlock> cameras;
  double cost = 0;
  bool valid = true;
};

class Worker {
 public:
  Worker(const BundleLayout& layout, const BundleState& state, Linearisation& result,
         ChunkSums& sums, bool derivatives)
      : layout_(layout), state_(state), result_(result), sums_(sums), derivatives_(derivatives) {
    sums.cameras.resize(layout.free_cameras.size());
  }

  // Returns false without any effect if the point is behind one of its cameras.
  bool Add(int j, const Eigen::Vector3d& X) {
    const BundlePoint& point = layout_.points[j];
    const int pairs = (point.end - point.begin + 1) / 2;
    if (static_cast<int>(terms_.size()) < pairs) terms_.resize(pairs);
    Mask2 in_front{-1, -1};
    for (int n = 0; n < pairs; ++n) {
      const int i = point.begin + 2 * n;
      const bool alone = i + 1 == point.end;  // processed twice, counted once
      const BundleSighting& s0 = layout_.sightings[i];
      const BundleSighting& s1 = layout_.sightings[alone ? i : i + 1];
      terms_[n] = Look(layout_.intrinsics, state_.cameras[s0.camera], state_.cameras[s1.camera], X,
                       s0, s1, Double2{1, alone ? 0.0 : 1.0});
      in_front &= terms_[n].in_front;
    }
    if (!(in_front[0] & in_front[1])) return false;
    Double2 H[6]{}, g[3]{}, cost{};
    if (!derivatives_) {
      for (int n = 0; n < pairs; ++n) cost += terms_[n].cost;
      sums_.cost += Sum(cost);
      return true;
    }
    Coupling* coupling = result_.couplings.data() + point.coupling;
    for (int n = 0; n < pairs; ++n) {
      const Terms& t = terms_[n];
      for (int d = 0; d < 6; ++d) H[d] += t.N[d];
      for (int d = 0; d < 3; ++d) g[d] += t.g[d];
      cost += t.cost;
      const int i = point.begin + 2 * n;
      if (i >= point.free_end) continue;
      const int slot0 = layout_.sightings[i].slot;
      const bool both = i + 1 < point.free_end;
      const int slot1 = both ? layout_.sightings[i + 1].slot : -1;
      AddToCameras(t, sums_.cameras[slot0], both ? &sums_.cameras[slot1] : nullptr);
      StoreCoupling(t, 0, slot0, *coupling++);
      if (both) StoreCoupling(t, 1, slot1, *coupling++);
    }
    PointBlock& block = result_.points[j];
    for (int d = 0; d < 6; ++d) block.H[d] = Sum(H[d]);
    for (int d = 0; d < 3; ++d) block.g[d] = Sum(g[d]);
    sums_.cost += Sum(cost);
    return true;
  }

 private:
  const BundleLayout& layout_;
  const BundleState& state_;
  Linearisation& result_;
  ChunkSums& sums_;
  bool derivatives_;
  std::vector<Terms> terms_;  // of the current point
};

}  // namespace

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
    Worker worker(layout, state, result, sums[chunk], derivatives);
    for (int j = layout.chunks[chunk]; j < layout.chunks[chunk + 1]; ++j) {
      if (worker.Add(j, state.points[j])) continue;
      if (before) state.points[j] = before->points[j];
      if (!before || !worker.Add(j, state.points[j])) {
        sums[chunk].valid = false;
        return;
      }
    }
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
