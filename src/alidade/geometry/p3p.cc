// P3P by Lambda Twist (Persson & Nordberg 2018). The distances along the rays are the intersection
// of two conics, found through the degenerate member of their pencil, which is a pair of lines.
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "alidade/geometry/pnp.h"

namespace alidade {
namespace {

// Real roots of x³ + b x² + c x + d.
std::vector<double> CubicRoots(double b, double c, double d) {
  // x = y - b / 3: y³ + 3 p y + 2 q = 0.
  const double p = c / 3 - b * b / 9, q = b * b * b / 27 - b * c / 6 + d / 2;
  std::vector<double> roots;
  if (q * q + p * p * p > 0) {
    const double root = std::sqrt(q * q + p * p * p);
    const double u = std::cbrt(q > 0 ? -q - root : -q + root);
    roots = {u == 0 ? 0 : u - p / u};
  } else {
    const double r = std::sqrt(-p);
    const double angle = r == 0 ? 0 : std::acos(std::clamp(-q / (r * r * r), -1.0, 1.0));
    for (int k = 0; k < 3; ++k)
      roots.push_back(2 * r * std::cos((angle - 2 * k * std::numbers::pi) / 3));
  }
  for (double& x : roots) {
    x -= b / 3;
    // Two Newton steps recover the digits that the closed form loses.
    for (int i = 0; i < 2; ++i) {
      const double slope = (3 * x + 2 * b) * x + c;
      if (slope != 0) x -= (((x + b) * x + c) * x + d) / slope;
    }
  }
  return roots;
}

// adj(m) for symmetric m.
Eigen::Matrix3d Adjugate(const Eigen::Matrix3d& m) {
  Eigen::Matrix3d result;
  result.col(0) = m.col(1).cross(m.col(2));
  result.col(1) = m.col(2).cross(m.col(0));
  result.col(2) = m.col(0).cross(m.col(1));
  return result;
}

// The degenerate conic D1 + gamma D2, given by the normals of its two lines. `found` is false if no
// member of the pencil is a pair of real lines.
struct LinePair {
  bool found = false;
  double gamma = 0;
  std::array<Eigen::Vector3d, 2> normal;
};

LinePair FindLinePair(const Eigen::Matrix3d& D1, const Eigen::Matrix3d& D2) {
  const double c3 = D2.determinant(), c0 = D1.determinant();
  const double c2 = (Adjugate(D2) * D1).trace(), c1 = (Adjugate(D1) * D2).trace();
  LinePair best;
  double sharpest = 0;
  for (const double gamma : CubicRoots(c2 / c3, c1 / c3, c0 / c3)) {
    if (!std::isfinite(gamma)) continue;
    Eigen::Matrix3d D0 = D1 + gamma * D2;
    D0 /= D0.norm();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spectrum(D0);
    // One eigenvalue is zero; the lines are real if the other two (smallest and largest) differ in
    // sign.
    const double low = spectrum.eigenvalues()[0], high = spectrum.eigenvalues()[2];
    if (!(-low * high > sharpest)) continue;
    sharpest = -low * high;
    best.found = true;
    best.gamma = gamma;
    const Eigen::Vector3d u = std::sqrt(-low) * spectrum.eigenvectors().col(0);
    const Eigen::Vector3d v = std::sqrt(high) * spectrum.eigenvectors().col(2);
    best.normal = {u + v, u - v};
  }
  return best;
}

// Residual of the law of cosines: squared side lengths from the distances along the rays, minus the
// true ones.
struct Triangle {
  double a12, a13, a23;  // squared sides
  double b12, b13, b23;  // cosines between the rays

  Eigen::Vector3d Error(const Eigen::Vector3d& l) const {
    return {l[0] * l[0] + l[1] * l[1] - 2 * b12 * l[0] * l[1] - a12,
            l[0] * l[0] + l[2] * l[2] - 2 * b13 * l[0] * l[2] - a13,
            l[1] * l[1] + l[2] * l[2] - 2 * b23 * l[1] * l[2] - a23};
  }
  Eigen::Vector3d Refined(Eigen::Vector3d l) const {
    for (int i = 0; i < 3; ++i) {
      Eigen::Matrix3d J;
      J << l[0] - b12 * l[1], l[1] - b12 * l[0], 0,  //
          l[0] - b13 * l[2], 0, l[2] - b13 * l[0],   //
          0, l[1] - b23 * l[2], l[2] - b23 * l[1];
      const Eigen::Vector3d next = l - 0.5 * J.inverse() * Error(l);
      if (!(Error(next).squaredNorm() < Error(l).squaredNorm())) break;
      l = next;
    }
    return l;
  }
};

// Right-handed orthonormal axes spanned by a triangle.
Eigen::Matrix3d Axes(const Eigen::Vector3d& p0, const Eigen::Vector3d& p1,
                     const Eigen::Vector3d& p2) {
  Eigen::Matrix3d axes;
  axes.col(0) = (p1 - p0).normalized();
  axes.col(2) = (p1 - p0).cross(p2 - p0).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

}  // namespace

std::vector<Se3> SolveP3p(const Eigen::Vector3d p_world[3], const Eigen::Vector3d rays[3]) {
  const Eigen::Vector3d &x0 = p_world[0], &x1 = p_world[1], &x2 = p_world[2];
  Triangle triangle{(x0 - x1).squaredNorm(), (x0 - x2).squaredNorm(), (x1 - x2).squaredNorm(),
                    rays[0].dot(rays[1]),    rays[0].dot(rays[2]),    rays[1].dot(rays[2])};
  const double size = std::max({triangle.a12, triangle.a13, triangle.a23});
  // Collinear, coincident or non-finite points.
  if (!((x1 - x0).cross(x2 - x0).norm() > 1e-9 * size)) return {};
  // Scale the triangle to unit size so that the tolerances below are absolute.
  const double unit = std::sqrt(size);
  triangle.a12 /= size;
  triangle.a13 /= size;
  triangle.a23 /= size;

  Eigen::Matrix3d M12, M13, M23;
  M12 << 1, -triangle.b12, 0, -triangle.b12, 1, 0, 0, 0, 0;
  M13 << 1, 0, -triangle.b13, 0, 0, 0, -triangle.b13, 0, 1;
  M23 << 0, 0, 0, 0, 1, -triangle.b23, 0, -triangle.b23, 1;
  Eigen::Matrix3d D1 = triangle.a23 * M12 - triangle.a12 * M23;
  Eigen::Matrix3d D2 = triangle.a23 * M13 - triangle.a13 * M23;
  // The cubic needs a D2 that is not degenerate itself, which happens in symmetric configurations.
  // At most three members of the pencil are degenerate, so one of these four is far from it.
  const Eigen::Matrix3d first = D1, second = D2;
  for (int k = 0; k < 4; ++k) {
    const double angle = k * std::numbers::pi / 4;
    const Eigen::Matrix3d member = std::cos(angle) * second - std::sin(angle) * first;
    if (k > 0 && !(std::abs(member.determinant()) > std::abs(D2.determinant()))) continue;
    D1 = std::cos(angle) * first + std::sin(angle) * second;
    D2 = member;
  }
  const LinePair lines = FindLinePair(D1, D2);
  if (!lines.found) return {};
  // Intersect the lines with the conic that is less similar to the degenerate one.
  const Eigen::Matrix3d& other = std::abs(lines.gamma) > 1 ? D1 : D2;
  const double sides = triangle.a12 + triangle.a13 + triangle.a23;

  std::vector<Se3> poses;
  for (const Eigen::Vector3d& normal : lines.normal) {
    // On the line, distances are f u + g v up to scale: a quadratic equation for f : g.
    const Eigen::Vector3d u = normal.unitOrthogonal(), v = normal.normalized().cross(u);
    const double uu = u.dot(other * u), uv = u.dot(other * v), vv = v.dot(other * v);
    const double discriminant = uv * uv - uu * vv;
    // Tangent case, where two solutions merge: rounding must not lose them.
    if (!(discriminant > -1e-12)) continue;
    const double root = std::sqrt(std::max(0.0, discriminant));
    const double q = uv > 0 ? -uv - root : -uv + root;
    for (const Eigen::Vector2d& fg : {Eigen::Vector2d(q, uu), Eigen::Vector2d(vv, q)}) {
      Eigen::Vector3d l = fg[0] * u + fg[1] * v;
      if (l.sum() < 0) l = -l;
      const double square = l.dot((M12 + M13 + M23) * l);
      if (!(square > 0)) continue;
      l = triangle.Refined(l * std::sqrt(sides / square));
      if (!(l.minCoeff() > 0) || !(triangle.Error(l).norm() < 1e-6)) continue;
      l *= unit;
      const Eigen::Vector3d y0 = l[0] * rays[0], y1 = l[1] * rays[1], y2 = l[2] * rays[2];
      Se3 T_camera_world;
      T_camera_world.R = Axes(y0, y1, y2) * Axes(x0, x1, x2).transpose();
      T_camera_world.t = (y0 + y1 + y2 - T_camera_world.R * (x0 + x1 + x2)) / 3;
      if (T_camera_world.R.allFinite()) poses.push_back(T_camera_world);
    }
  }
  return poses;
}

}  // namespace alidade
