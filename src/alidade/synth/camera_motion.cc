// The derivatives of CameraPath::At.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "alidade/synth/camera_path.h"

namespace alidade {
namespace {

using Eigen::Vector3d;

// Right Jacobian of SO(3), J = I - a S + b S² with S = Skew(v), a = (1 - cos |v|) / |v|² and
// b = (|v| - sin |v|) / |v|³, and its derivative by time where v changes at the rate `v1`.
// The coefficients are summed as power series of q = |v|², exact without cases for small angles.
struct JacobianJet {
  Eigen::Matrix3d value, first;
};
JacobianJet RightJacobianJet(const Vector3d& v, const Vector3d& v1) {
  const double q = v.squaredNorm();
  double a = 0, b = 0, a_by_q = 0, b_by_q = 0;
  double term = 0.5, by_q = 0;  // (-q)^k / (2k + 2)!, and its derivative by q
  for (int k = 0; k < 16; ++k) {
    a += term;
    a_by_q += by_q;
    b += term / (2 * k + 3);
    b_by_q += by_q / (2 * k + 3);
    const double next = -1.0 / ((2 * k + 3) * (2 * k + 4));
    by_q = next * (term + q * by_q);
    term *= next * q;
  }
  const double q1 = 2 * v.dot(v1);
  const Eigen::Matrix3d S = Skew(v), S1 = Skew(v1);
  return {Eigen::Matrix3d::Identity() - a * S + b * S * S,
          -a_by_q * q1 * S - a * S1 + b_by_q * q1 * S * S + b * (S * S1 + S1 * S)};
}

}  // namespace

std::array<PathKnot, 2> CameraPath::SplineDerivatives(double time) const {
  const int count = static_cast<int>(knots_.size());
  const double rate = count / period_;
  const double s = time / period_ * count;
  const double whole = std::floor(s), f = s - whole;
  const double first[4] = {-(1 - f) * (1 - f) / 2, (3 * f * f - 4 * f) / 2,
                           (-3 * f * f + 2 * f + 1) / 2, f * f / 2};
  const double second[4] = {1 - f, 3 * f - 2, 1 - 3 * f, f};
  std::array<PathKnot, 2> by{PathKnot{Vector3d::Zero(), 0, 0}, PathKnot{Vector3d::Zero(), 0, 0}};
  for (int i = 0; i < 4; ++i) {
    const long index = static_cast<long>(whole) + i - 1;
    const long round = index >= 0 ? index / count : -((-index + count - 1) / count);
    const PathKnot& knot = knots_[static_cast<size_t>(index - round * count)];
    const double yaw = knot.yaw + 2 * std::numbers::pi * turns_ * static_cast<double>(round);
    const double weights[2] = {rate * first[i], rate * rate * second[i]};
    for (int order = 0; order < 2; ++order) {
      by[order].position += weights[order] * knot.position;
      by[order].yaw += weights[order] * yaw;
      by[order].pitch += weights[order] * knot.pitch;
    }
  }
  return by;
}

CameraPath::Jet CameraPath::ShakeJet(int axis, double time) const {
  Jet jet{0, 0, 0};
  for (const Wave& wave : waves_[axis]) {
    const double angle = wave.frequency * time + wave.phase;
    jet.value += wave.amplitude * std::sin(angle);
    jet.first += wave.amplitude * wave.frequency * std::cos(angle);
    jet.second -= wave.amplitude * wave.frequency * wave.frequency * std::sin(angle);
  }
  return jet;
}

CameraPath::Jet CameraPath::WalkedJet(double time) const {
  if (timing_.turn_first == 0) return {Walked(time), timing_.speed, 0};
  const double since = std::clamp(time - timing_.turn_first, 0.0, 1.0);
  return {Walked(time), timing_.speed * since * since * (3 - 2 * since),
          timing_.speed * 6 * since * (1 - since)};
}

PathMotion CameraPath::MotionAt(double time) const {
  const Jet walked = WalkedJet(time);
  const PathKnot at = Spline(walked.value);
  const std::array<PathKnot, 2> by = SplineDerivatives(walked.value);
  // Of a value along the path, by time.
  const auto first = [&](const auto& by_first) { return (by_first * walked.first).eval(); };
  const auto second = [&](const auto& by_first, const auto& by_second) {
    return (by_second * walked.first * walked.first + by_first * walked.second).eval();
  };
  using Angles = Eigen::Vector2d;  // yaw, pitch
  const Angles angles_by(by[0].yaw, by[0].pitch), angles_by2(by[1].yaw, by[1].pitch);
  Angles angle1 = first(angles_by), angle2 = second(angles_by, angles_by2);

  Jet moving{1, 0, 0};  // share of the shake of position
  if (timing_.turn_first > 0 && time < timing_.turn_first + 1) {
    const double since = std::max(0.0, time - timing_.turn_first);
    moving.value = since * since * (3 - 2 * since);
    if (time >= timing_.turn_first) {
      moving.first = 6 * since * (1 - since);
      moving.second = 6 - 12 * since;
    } else {  // yaw: + turn_angle sin²(rate time)
      const double rate = std::numbers::pi / timing_.turn_first;
      angle1[0] += timing_.turn_angle * rate * std::sin(2 * rate * time);
      angle2[0] += timing_.turn_angle * 2 * rate * rate * std::cos(2 * rate * time);
    }
  }

  Vector3d shift, shift1, shift2, turn, turn1, turn2;
  for (int axis = 0; axis < 3; ++axis) {
    const Jet s = ShakeJet(axis, time), r = ShakeJet(axis + 3, time);
    shift[axis] = s.value, shift1[axis] = s.first, shift2[axis] = s.second;
    turn[axis] = r.value, turn1[axis] = r.first, turn2[axis] = r.second;
  }

  PathMotion motion;
  motion.T_world_camera = At(time);
  motion.velocity = first(by[0].position) + moving.value * shift1 + moving.first * shift;
  motion.acceleration = second(by[0].position, by[1].position) + moving.value * shift2 +
                        2 * moving.first * shift1 + moving.second * shift;
  // R = LookAlong(yaw, pitch) Exp(turn). The first factor turns about the vertical, which is
  // (0, -cos pitch, sin pitch) in its axes, and about its x axis.
  const double c = std::cos(at.pitch), s = std::sin(at.pitch);
  const Vector3d look1(angle1[1], -c * angle1[0], s * angle1[0]);
  const Vector3d look2(angle2[1], s * angle1[1] * angle1[0] - c * angle2[0],
                       c * angle1[1] * angle1[0] + s * angle2[0]);
  const Eigen::Matrix3d E = ExpSo3(turn).transpose();
  const JacobianJet J = RightJacobianJet(turn, turn1);
  const Vector3d shaken = J.value * turn1;
  motion.angular_rate = E * look1 + shaken;
  motion.angular_acceleration =
      E * look2 - shaken.cross(E * look1) + J.value * turn2 + J.first * turn1;
  return motion;
}

}  // namespace alidade
