#include "alidade/calibration/lens_window.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "alidade/optimize/reprojection.h"

namespace alidade {
namespace {

using ByLens = Eigen::Matrix<double, 2, LensAdjustment::kParameters>;

// Derivative of distorted by ideal radius. Below this the distortion model is not invertible.
constexpr double kLeastSlope = 0.1;

struct LensRow {
  int camera = -1;
  Eigen::Vector2d residual;
  Eigen::Matrix<double, 2, 6> by_camera;  // translation, rotation: left-multiplied
  Eigen::Matrix<double, 2, 3> by_point;
  ByLens by_lens;
  double weight = 0;
};

// Residual of one observation, pixels. Returns false behind the camera or outside the valid range
// of the distortion model.
bool Residual(const RadialLens& lens, const Eigen::Vector3d& p, const Eigen::Vector2d& seen,
              Eigen::Vector2d& residual) {
  if (!(p.z() > kMinDepth)) return false;
  const Eigen::Vector2d ideal = p.head<2>() / p.z();
  const double r2 = ideal.squaredNorm();
  if (!(1 + r2 * (3 * lens.k1 + 5 * r2 * lens.k2) > kLeastSlope)) return false;
  residual = lens.centre + lens.focal * (1 + r2 * (lens.k1 + r2 * lens.k2)) * ideal - seen;
  return true;
}

// Motion from the middle of the image to the readout time of the observation's row.
Se3 WhenRead(const RadialLens& lens, const LensWindow& window, const LensObservation& o) {
  if (window.motions.empty() || lens.readout.isZero(0)) return {};
  return Se3::Exp(lens.readout.dot(o.read) * window.motions[static_cast<size_t>(o.camera)]);
}

bool LineariseLens(const RadialLens& lens, const LensWindow& window, const LensObservation& o,
                   LensRow& row) {
  const Se3& T_camera_world = window.T_camera_world[static_cast<size_t>(o.camera)];
  const Se3 T_read_camera = WhenRead(lens, window, o);
  const Eigen::Vector3d at_middle = T_camera_world * window.points[static_cast<size_t>(o.point)];
  const Eigen::Vector3d p = T_read_camera * at_middle;
  if (!Residual(lens, p, o.pixel, row.residual)) return false;
  const double x = p.x() / p.z(), y = p.y() / p.z(), r2 = x * x + y * y;
  const double d = 1 + r2 * (lens.k1 + r2 * lens.k2), slope = lens.k1 + 2 * r2 * lens.k2;
  Eigen::Matrix2d by_ideal;
  by_ideal << d + 2 * x * x * slope, 2 * x * y * slope, 2 * x * y * slope, d + 2 * y * y * slope;
  Eigen::Matrix<double, 2, 3> of_point;  // derivative of the ideal point by p
  of_point << 1 / p.z(), 0, -x / p.z(), 0, 1 / p.z(), -y / p.z();
  const Eigen::Matrix<double, 2, 3> by_p = lens.focal * by_ideal * of_point;
  const auto cross = [](const Eigen::Vector3d& v) {
    return (Eigen::Matrix3d() << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0).finished();
  };
  const Eigen::Matrix<double, 2, 3> by_middle = by_p * T_read_camera.R;
  row.by_camera << by_middle, -by_middle * cross(at_middle);
  row.by_point = by_middle * T_camera_world.R;
  const Eigen::Vector2d ideal(x, y);
  row.by_lens << lens.focal * d * ideal, lens.focal * r2 * ideal, lens.focal * r2 * r2 * ideal,
      Eigen::Matrix2d::Identity(), Eigen::Matrix2d::Zero();
  if (!window.motions.empty()) {
    // d Exp(s v) p / ds = v.head + v.tail × p, and s = readout · read.
    const Vector6d& v = window.motions[static_cast<size_t>(o.camera)];
    const Eigen::Vector2d flow = by_p * (v.head<3>() + v.tail<3>().cross(p));
    row.by_lens.rightCols<2>() = flow * o.read.transpose();
  }
  return true;
}

void EliminatePoint(const std::vector<LensRow>& rows, double damping, WindowSystem& system,
                    WindowSystem::Point& point) {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  point.g.setZero();
  point.by_lens.setZero();
  for (const LensRow& row : rows) {
    H += row.weight * row.by_point.transpose() * row.by_point;
    point.g += row.weight * row.by_point.transpose() * row.residual;
    point.by_lens += row.weight * row.by_lens.transpose() * row.by_point;
    point.by_camera.emplace_back(row.camera, row.weight * row.by_camera.transpose() * row.by_point);
  }
  H.diagonal() *= 1 + damping;
  point.inverse = H.inverse();
  if (!point.inverse.allFinite()) {
    point.by_camera.clear();
    return;
  }
  for (const LensRow& row : rows) {
    const Eigen::Index c = 6 * row.camera;
    system.H.block<6, 6>(c, c) += row.weight * row.by_camera.transpose() * row.by_camera;
    system.lens_by_pose.block<LensAdjustment::kParameters, 6>(0, c) +=
        row.weight * row.by_lens.transpose() * row.by_camera;
    system.lens += row.weight * row.by_lens.transpose() * row.by_lens;
    system.g.segment<6>(c) += row.weight * row.by_camera.transpose() * row.residual;
    system.g_lens += row.weight * row.by_lens.transpose() * row.residual;
  }
  system.observations += static_cast<int>(rows.size());
  for (const auto& [i, Hi] : point.by_camera) {
    const Eigen::Matrix<double, 6, 3> A = Hi * point.inverse;
    system.g.segment<6>(6 * i) -= A * point.g;
    system.lens_by_pose.block<LensAdjustment::kParameters, 6>(0, 6 * i) -=
        point.by_lens * A.transpose();
    for (const auto& [j, Hj] : point.by_camera) {
      if (j <= i) system.H.block<6, 6>(6 * i, 6 * j) -= A * Hj.transpose();
    }
  }
  system.lens -= point.by_lens * point.inverse * point.by_lens.transpose();
  system.g_lens -= point.by_lens * point.inverse * point.g;
}

}  // namespace

WindowSystem SystemOf(const LensWindow& window, const RadialLens& lens, const LensLoss& loss,
                      double damping) {
  const auto size = 6 * static_cast<Eigen::Index>(window.T_camera_world.size());
  WindowSystem system;
  system.H = Eigen::MatrixXd::Zero(size, size);
  system.lens_by_pose = Eigen::MatrixXd::Zero(LensAdjustment::kParameters, size);
  system.g = Eigen::VectorXd::Zero(size);
  system.points.resize(window.points.size());
  std::vector<LensRow> rows;
  const auto& all = window.observations;
  for (size_t i = 0; i < all.size(); ++i) {
    const LensObservation& o = all[i];
    LensRow row;
    row.camera = o.camera;
    if (LineariseLens(lens, window, o, row)) {
      row.weight = o.inv_sigma2 * loss.Weight(o.inv_sigma2 * row.residual.squaredNorm());
      rows.push_back(row);
    }
    if (i + 1 < all.size() && all[i + 1].point == o.point) continue;
    if (rows.size() >= 2)
      EliminatePoint(rows, damping, system, system.points[static_cast<size_t>(o.point)]);
    rows.clear();
  }
  return system;
}

LensSystem LensAlone(const WindowSystem& system, double damping) {
  LensSystem alone;
  Eigen::MatrixXd H = system.H;
  // Keeps the pose of a camera without observations constant; the damping fixes the gauge of the
  // others.
  const double least = 1e-12 * std::max(1.0, H.diagonal().maxCoeff());
  H.diagonal() = (H.diagonal() * (1 + damping)).cwiseMax(least);
  alone.poses.compute(H);  // uses only the lower triangle
  alone.H = system.lens - system.lens_by_pose * alone.poses.solve(system.lens_by_pose.transpose());
  alone.g = system.g_lens - system.lens_by_pose * alone.poses.solve(system.g);
  return alone;
}

void MoveWindow(const WindowSystem& system, const LensSystem& alone, const LensVector& lens_step,
                LensWindow& window) {
  const Eigen::VectorXd step =
      -alone.poses.solve(system.g + system.lens_by_pose.transpose() * lens_step);
  for (size_t i = 0; i < window.T_camera_world.size(); ++i) {
    Se3& T = window.T_camera_world[i];
    T = Se3::Exp(step.segment<6>(6 * static_cast<Eigen::Index>(i))) * T;
  }
  for (size_t i = 0; i < window.points.size(); ++i) {
    const WindowSystem::Point& point = system.points[i];
    if (point.by_camera.empty()) continue;
    Eigen::Vector3d right = point.g + point.by_lens.transpose() * lens_step;
    for (const auto& [camera, H] : point.by_camera)
      right += H.transpose() * step.segment<6>(6 * camera);
    window.points[i] -= point.inverse * right;
  }
}

std::vector<double> ChiSquaredOf(const LensWindow& window, const RadialLens& lens) {
  std::vector<double> all;
  all.reserve(window.observations.size());
  for (const LensObservation& o : window.observations) {
    Eigen::Vector2d residual;
    const Eigen::Vector3d p =
        WhenRead(lens, window, o) * (window.T_camera_world[static_cast<size_t>(o.camera)] *
                                     window.points[static_cast<size_t>(o.point)]);
    const bool seen = Residual(lens, p, o.pixel, residual);
    all.push_back(seen ? o.inv_sigma2 * residual.squaredNorm()
                       : std::numeric_limits<double>::infinity());
  }
  return all;
}

}  // namespace alidade
