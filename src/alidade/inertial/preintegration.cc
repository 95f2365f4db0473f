#include "alidade/inertial/preintegration.h"

#include <algorithm>
#include <cmath>

namespace alidade {
namespace {

// A step longer than this is cut into equal parts, so that a gap in the readings is integrated as
// accurately as the rest.
constexpr double kLongestStep = 0.01;  // seconds
// A hand moves at up to 2.5 Hz: readings further apart than half a period do not tell its motion.
constexpr double kLongestSilence = 0.2;  // seconds
// Standard deviations of what it does meanwhile, per axis. The force turns with the sensor.
constexpr double kUnseenRate = 1, kUnseenForce = 5;  // rad/s, m/s²

ImuSample Between(const ImuSample& a, const ImuSample& b, double time) {
  const double span = b.time - a.time;
  const double share = span > 0 ? std::clamp((time - a.time) / span, 0.0, 1.0) : 1;
  return {time, a.angular_rate + share * (b.angular_rate - a.angular_rate),
          a.specific_force + share * (b.specific_force - a.specific_force)};
}

// Calls `step` with the readings at the ends of each interval between `from` and `to`, and with the
// time without a reading that the interval is part of, in seconds.
template <typename Step>
void ForEachStep(std::span<const ImuSample> samples, double from, double to, Step&& step) {
  if (samples.empty()) return;
  auto sample = std::upper_bound(samples.begin(), samples.end(), from,
                                 [](double at, const ImuSample& s) { return at < s.time; });
  const auto silence = [&] {
    const double begin = sample == samples.begin() ? from : std::prev(sample)->time;
    return (sample == samples.end() ? to : sample->time) - begin;
  };
  ImuSample last = ReadingAt(samples, from);
  for (; sample != samples.end() && sample->time < to; ++sample) {
    step(last, *sample, silence());
    last = *sample;
  }
  step(last, ReadingAt(samples, to), silence());
}

// White noise that gives the same variance of the change over a silence as a constant error of
// standard deviation s: density² silence = (s silence)².
ImuNoise Unseen(ImuNoise noise, double silence) {
  noise.gyro = std::hypot(noise.gyro, kUnseenRate * std::sqrt(silence));
  noise.accel = std::hypot(noise.accel, kUnseenForce * std::sqrt(silence));
  return noise;
}

}  // namespace

Eigen::Matrix3d RightJacobian(const Eigen::Vector3d& v) {
  const double angle = v.norm();
  const Eigen::Matrix3d S = Skew(v);
  if (angle < 1e-4) return Eigen::Matrix3d::Identity() - 0.5 * S + S * S / 6;
  const double a2 = angle * angle;
  return Eigen::Matrix3d::Identity() - (1 - std::cos(angle)) / a2 * S +
         (angle - std::sin(angle)) / (a2 * angle) * S * S;
}

Eigen::Matrix3d InverseRightJacobian(const Eigen::Vector3d& v) {
  const double angle = v.norm();
  const Eigen::Matrix3d S = Skew(v);
  if (angle < 1e-4) return Eigen::Matrix3d::Identity() + 0.5 * S + S * S / 12;
  const double half = angle / 2;
  return Eigen::Matrix3d::Identity() + 0.5 * S +
         (1 - half * std::cos(half) / std::sin(half)) / (angle * angle) * S * S;
}

void Preintegration::Append(double dt, const Eigen::Vector3d& angular_rate,
                            const Eigen::Vector3d& specific_force, const ImuNoise& noise) {
  if (!(dt > 0)) return;
  const Eigen::Vector3d turn = (angular_rate - bias.gyro) * dt;
  const Eigen::Vector3d a = specific_force - bias.accel;
  const Eigen::Matrix3d half = ExpSo3(turn / 2), whole = ExpSo3(turn);
  const Eigen::Matrix3d R_middle = dR * half;
  const Eigen::Matrix3d R_a = -R_middle * Skew(a);  // derivative of R_middle a by its rotation
  const Eigen::Matrix3d half_by_turn = half.transpose();
  const Eigen::Matrix3d half_by_rate = RightJacobian(turn / 2) * (dt / 2);

  Matrix9d A = Matrix9d::Identity();  // new error by old error
  A.block<3, 3>(0, 0) = whole.transpose();
  A.block<3, 3>(3, 0) = R_a * half_by_turn * dt;
  A.block<3, 3>(6, 0) = R_a * half_by_turn * (dt * dt / 2);
  A.block<3, 3>(6, 3) = Eigen::Matrix3d::Identity() * dt;
  Matrix96d B = Matrix96d::Zero();  // new error by (angular rate; specific force)
  B.block<3, 3>(0, 0) = RightJacobian(turn) * dt;
  B.block<3, 3>(3, 0) = R_a * half_by_rate * dt;
  B.block<3, 3>(6, 0) = R_a * half_by_rate * (dt * dt / 2);
  B.block<3, 3>(3, 3) = R_middle * dt;
  B.block<3, 3>(6, 3) = R_middle * (dt * dt / 2);

  Vector6d variance;
  variance << Eigen::Vector3d::Constant(noise.gyro * noise.gyro / dt),
      Eigen::Vector3d::Constant(noise.accel * noise.accel / dt);
  covariance = A * covariance * A.transpose() + B * variance.asDiagonal() * B.transpose();
  by_bias = A * by_bias - B;
  dp += dv * dt + R_middle * a * (dt * dt / 2);
  dv += R_middle * a * dt;
  dR = dR * whole;
  seconds += dt;
}

Preintegration Preintegration::WithBias(const ImuBias& other) const {
  Vector6d change;
  change << other.gyro - bias.gyro, other.accel - bias.accel;
  const Vector9d by = by_bias * change;
  Preintegration changed = *this;
  changed.bias = other;
  changed.dR = dR * ExpSo3(by.head<3>());
  changed.dv += by.segment<3>(3);
  changed.dp += by.tail<3>();
  return changed;
}

Preintegration Preintegration::Then(const Preintegration& next) const {
  const Preintegration later = next.WithBias(bias);
  // The new error by that of each part.
  Matrix9d by_this = Matrix9d::Identity(), by_next = Matrix9d::Zero();
  by_this.block<3, 3>(0, 0) = later.dR.transpose();
  by_this.block<3, 3>(3, 0) = -dR * Skew(later.dv);
  by_this.block<3, 3>(6, 0) = -dR * Skew(later.dp);
  by_this.block<3, 3>(6, 3) = later.seconds * Eigen::Matrix3d::Identity();
  by_next.block<3, 3>(0, 0).setIdentity();
  by_next.block<3, 3>(3, 3) = by_next.block<3, 3>(6, 6) = dR;
  Preintegration both;
  both.seconds = seconds + later.seconds;
  both.bias = bias;
  both.dR = dR * later.dR;
  both.dv = dv + dR * later.dv;
  both.dp = dp + dv * later.seconds + dR * later.dp;
  both.covariance =
      by_this * covariance * by_this.transpose() + by_next * later.covariance * by_next.transpose();
  both.by_bias = by_this * by_bias + by_next * later.by_bias;
  return both;
}

ImuSample ReadingAt(std::span<const ImuSample> samples, double time) {
  const auto next =
      std::lower_bound(samples.begin(), samples.end(), time,
                       [](const ImuSample& sample, double at) { return sample.time < at; });
  if (next == samples.begin()) return {time, next->angular_rate, next->specific_force};
  if (next == samples.end())
    return {time, samples.back().angular_rate, samples.back().specific_force};
  return Between(*std::prev(next), *next, time);
}

Preintegration Preintegrate(std::span<const ImuSample> samples, double from, double to,
                            const ImuBias& bias, const ImuNoise& noise) {
  Preintegration motion;
  motion.bias = bias;
  ForEachStep(samples, from, to, [&](const ImuSample& last, const ImuSample& next, double silence) {
    const double span = next.time - last.time;
    const ImuNoise present = silence > kLongestSilence ? Unseen(noise, silence) : noise;
    const int steps = std::max(1, static_cast<int>(std::ceil(span / kLongestStep)));
    for (int k = 0; k < steps; ++k) {
      const ImuSample middle = Between(last, next, last.time + span * (k + 0.5) / steps);
      motion.Append(span / steps, middle.angular_rate, middle.specific_force, present);
    }
  });
  return motion;
}

Eigen::Matrix3d TurnOf(std::span<const ImuSample> samples, double from, double to,
                       const Eigen::Vector3d& gyro_bias) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  ForEachStep(samples, from, to, [&](const ImuSample& last, const ImuSample& next, double) {
    const Eigen::Vector3d rate = (last.angular_rate + next.angular_rate) / 2 - gyro_bias;
    R = R * ExpSo3((next.time - last.time) * rate);
  });
  return R;
}

bool TellMotion(std::span<const ImuSample> samples, double from, double to) {
  bool tell = !samples.empty();
  ForEachStep(samples, from, to, [&](const ImuSample&, const ImuSample&, double silence) {
    tell = tell && silence <= kLongestSilence;
  });
  return tell;
}

InertialState Predict(const InertialState& state, const Preintegration& motion,
                      const Eigen::Vector3d& gravity) {
  const Preintegration here = motion.WithBias(state.bias);
  const double t = here.seconds;
  const Eigen::Matrix3d& R = state.T_world_imu.R;
  InertialState next = state;
  next.T_world_imu.R = R * here.dR;
  next.T_world_imu.t += state.velocity * t + gravity * (t * t / 2) + R * here.dp;
  next.velocity += gravity * t + R * here.dv;
  return next;
}

MotionResidual ResidualOf(const InertialState& i, const InertialState& j,
                          const Preintegration& motion, const Eigen::Vector3d& gravity) {
  const double t = motion.seconds;
  const Eigen::Matrix3d Ri_t = i.T_world_imu.R.transpose();
  const Preintegration here = motion.WithBias(i.bias);
  const Eigen::Matrix3d turn = Ri_t * j.T_world_imu.R;
  const Eigen::Vector3d speed = Ri_t * (j.velocity - i.velocity - gravity * t);
  const Eigen::Vector3d way =
      Ri_t * (j.T_world_imu.t - i.T_world_imu.t - i.velocity * t - gravity * (t * t / 2));

  MotionResidual r;
  r.error << LogSo3(here.dR.transpose() * turn), speed - here.dv, way - here.dp;
  const Eigen::Vector3d rotation = r.error.head<3>();
  const Eigen::Matrix3d J = InverseRightJacobian(rotation);
  r.by_i.setZero();
  r.by_i.block<3, 3>(0, 0) = -J * turn.transpose();
  r.by_i.block<3, 3>(3, 0) = Skew(speed);
  r.by_i.block<3, 3>(6, 0) = Skew(way);
  r.by_i.block<3, 3>(3, 3) = -Ri_t;
  r.by_i.block<3, 3>(6, 3) = -Ri_t * t;
  r.by_i.block<3, 3>(6, 6) = -Ri_t;
  r.by_j.setZero();
  r.by_j.block<3, 3>(0, 0) = J;
  r.by_j.block<3, 3>(3, 3) = Ri_t;
  r.by_j.block<3, 3>(6, 6) = Ri_t;
  Vector6d change;
  change << i.bias.gyro - motion.bias.gyro, i.bias.accel - motion.bias.accel;
  const Eigen::Vector3d by = (motion.by_bias * change).head<3>();
  r.by_bias = -motion.by_bias;
  r.by_bias.topRows<3>() =
      -J * ExpSo3(rotation).transpose() * RightJacobian(by) * motion.by_bias.topRows<3>();
  r.by_gravity.setZero();
  r.by_gravity.middleRows<3>(3) = -Ri_t * t;
  r.by_gravity.bottomRows<3>() = -Ri_t * (t * t / 2);
  return r;
}

}  // namespace alidade
