#include "alidade/calibration/lens_bend.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <vector>

#include "alidade/optimize/reprojection.h"

namespace alidade {
namespace {

constexpr double kHuber = 2.447;  // sqrt(5.991): 95 % of chi² with 2 degrees of freedom
// Relative to the diagonal: fixes the gauge and points without parallax.
constexpr double kDamping = 1e-8;
constexpr int kLens = 2;  // parameters of the lens: log of the focal length, k1
using Lens = Eigen::Matrix<double, 3, kLens>;

// One observation: two residuals, and that of the disparity (weight 0 if there is none).
struct Row {
  int camera;
  Eigen::Matrix<double, 3, 6> by_camera;  // translation, rotation: left-multiplied
  Eigen::Matrix3d by_point;
  Lens by_lens;
  Eigen::Vector3d residual, weight;
};

// Returns false if the point is behind the camera.
bool Linearise(const BundleProblem& problem, const Intrinsics& k, const BundleObservation& o,
               Row& row) {
  const Se3& T = problem.T_camera_world[static_cast<size_t>(o.camera)];
  const Eigen::Vector3d p = T * problem.points[static_cast<size_t>(o.point)];
  if (!(p.z() > kMinDepth) || !o.pixel.head<2>().allFinite()) return false;
  const bool right = HasRight(k, o.pixel.z());
  const auto e =
      Reproject<double>(k, p.x(), p.y(), p.z(), o.pixel.x(), o.pixel.y(), right ? o.pixel.z() : 0);
  row.camera = o.camera;
  row.residual << e.u, e.v, right ? e.d : 0;
  row.weight << o.inv_sigma2, o.inv_sigma2, right ? o.inv_sigma2_right : 0;
  const double chi = std::sqrt(row.residual.cwiseAbs2().dot(row.weight));
  row.weight *= o.trust * (chi > kHuber ? kHuber / chi : 1);
  Eigen::Matrix3d by_p;  // derivative by the point in the camera frame
  by_p << e.u_x, 0, e.u_z, 0, e.v_y, e.v_z, 0, 0, e.d_z;
  Eigen::Matrix3d cross;
  cross << 0, -p.z(), p.y(), p.z(), 0, -p.x(), -p.y(), p.x(), 0;
  row.by_camera << by_p, -by_p * cross;
  row.by_point = by_p * T.R;
  const Eigen::Vector2d ideal(p.x() / p.z(), p.y() / p.z());
  const Eigen::Vector2d pixel(k.fx * ideal.x(), k.fy * ideal.y());
  row.by_lens << pixel, pixel * ideal.squaredNorm(), 0, 0;
  return true;
}

// J' W J and J' W r of poses and lens; points are eliminated one by one (Triggs et al. 2000, §6).
class Normal {
 public:
  explicit Normal(size_t cameras)
      : lens_(6 * static_cast<Eigen::Index>(cameras)),
        H_(Eigen::MatrixXd::Zero(lens_ + kLens, lens_ + kLens)),
        g_(Eigen::VectorXd::Zero(lens_ + kLens)) {}

  // Adds all observations of one point; each camera may observe it at most once.
  void Add(const std::vector<Row>& rows);
  std::optional<LensBend> Solve();

 private:
  void Eliminate(const std::vector<Row>& rows);

  Eigen::Index lens_;  // index of the first lens parameter
  Eigen::MatrixXd H_;  // lower triangle
  Eigen::VectorXd g_;
  double squares_ = 0;   // weighted sum of squared residuals
  double freedoms_ = 0;  // number of residuals minus the points' parameters
};

void Normal::Add(const std::vector<Row>& rows) {
  if (rows.size() < 2) return;
  for (const Row& row : rows) {
    const auto w = row.weight.asDiagonal();
    const Eigen::Index c = 6 * row.camera;
    H_.block<6, 6>(c, c) += row.by_camera.transpose() * w * row.by_camera;
    H_.block<kLens, 6>(lens_, c) += row.by_lens.transpose() * w * row.by_camera;
    H_.block<kLens, kLens>(lens_, lens_) += row.by_lens.transpose() * w * row.by_lens;
    g_.segment<6>(c) += row.by_camera.transpose() * w * row.residual;
    g_.segment<kLens>(lens_) += row.by_lens.transpose() * w * row.residual;
    squares_ += row.residual.cwiseAbs2().dot(row.weight);
    freedoms_ += static_cast<double>((row.weight.array() > 0).count());
  }
  freedoms_ -= 3;
  Eliminate(rows);
}

void Normal::Eliminate(const std::vector<Row>& rows) {
  Eigen::Matrix3d Hpp = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gp = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, kLens, 3> Hlp = Eigen::Matrix<double, kLens, 3>::Zero();
  std::vector<Eigen::Matrix<double, 6, 3>> Hcp;
  for (const Row& row : rows) {
    const auto w = row.weight.asDiagonal();
    Hpp += row.by_point.transpose() * w * row.by_point;
    gp += row.by_point.transpose() * w * row.residual;
    Hlp += row.by_lens.transpose() * w * row.by_point;
    Hcp.push_back(row.by_camera.transpose() * w * row.by_point);
  }
  Hpp.diagonal() *= 1 + kDamping;
  const Eigen::Matrix3d inverse = Hpp.inverse();
  if (!inverse.allFinite()) return;
  for (size_t i = 0; i < rows.size(); ++i) {
    const Eigen::Matrix<double, 6, 3> A = Hcp[i] * inverse;
    const Eigen::Index ci = 6 * rows[i].camera;
    g_.segment<6>(ci) -= A * gp;
    H_.block<kLens, 6>(lens_, ci) -= Hlp * A.transpose();
    for (size_t j = 0; j < rows.size(); ++j) {
      const Eigen::Index cj = 6 * rows[j].camera;
      if (cj <= ci) H_.block<6, 6>(ci, cj) -= A * Hcp[j].transpose();
    }
  }
  H_.block<kLens, kLens>(lens_, lens_) -= Hlp * inverse * Hlp.transpose();
  g_.segment<kLens>(lens_) -= Hlp * inverse * gp;
}

std::optional<LensBend> Normal::Solve() {
  const double left = freedoms_ - static_cast<double>(H_.rows());
  if (lens_ == 0 || left <= 0) return {};
  H_.diagonal().head(lens_) *= 1 + kDamping;
  const Eigen::LDLT<Eigen::MatrixXd> poses(H_.topLeftCorner(lens_, lens_));
  const Eigen::MatrixXd Hlc = H_.bottomLeftCorner(kLens, lens_);
  const Eigen::Matrix2d S = H_.bottomRightCorner(kLens, kLens) - Hlc * poses.solve(Hlc.transpose());
  const Eigen::Vector2d g = g_.tail(kLens) - Hlc * poses.solve(g_.head(lens_));
  const Eigen::Matrix2d covariance = S.inverse();
  const double k1 = -(covariance * g)(1), variance = covariance(1, 1) * squares_ / left;
  if (!std::isfinite(k1) || !(variance > 0) || !std::isfinite(variance)) return {};
  return LensBend{k1, std::sqrt(variance)};
}

}  // namespace

std::optional<LensBend> EstimateLensBend(const BundleProblem& problem) {
  const Intrinsics k = Intrinsics::Of(problem.camera);
  Normal normal(problem.T_camera_world.size());
  std::vector<Row> rows;
  const std::vector<BundleObservation>& all = problem.observations;
  for (size_t i = 0; i < all.size(); ++i) {
    Row row;
    if (Linearise(problem, k, all[i], row)) rows.push_back(row);
    if (i + 1 < all.size() && all[i + 1].point == all[i].point) continue;
    normal.Add(rows);
    rows.clear();
  }
  return normal.Solve();
}

}  // namespace alidade
