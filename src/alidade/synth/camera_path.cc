#include "alidade/synth/camera_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "alidade/base/random.h"

namespace alidade {

Eigen::Matrix3d LookAlong(double yaw, double pitch) {
  const Eigen::Vector3d forward(std::cos(yaw) * std::cos(pitch), std::sin(yaw) * std::cos(pitch),
                                std::sin(pitch));
  const Eigen::Vector3d right(std::sin(yaw), -std::cos(yaw), 0);
  Eigen::Matrix3d R;
  R << right, forward.cross(right), forward;
  return R;
}

CameraPath::CameraPath(std::vector<PathKnot> knots, double period, int turns,
                       const ShakeSettings& shake, uint64_t seed, const PathTiming& timing)
    : knots_(std::move(knots)), period_(period), turns_(turns), timing_(timing) {
  Random random(seed, 21);
  for (int axis = 0; axis < 6; ++axis) {
    const double scale = axis < 3 ? shake.position : shake.rotation;
    for (size_t i = 0; i < waves_[axis].size(); ++i) {
      // Evenly spaced in log frequency.
      const double octave =
          (static_cast<double>(i) + random.Uniform()) / static_cast<double>(waves_[axis].size());
      // Frequencies span a factor of 8. exp2 instead of pow(8, …), which some compilers replace by
      // it.
      const double hertz = (1 / shake.seconds) * std::exp2(3 * (octave - 1));
      waves_[axis][i] = {scale * std::sqrt(2.0 / static_cast<double>(waves_[axis].size())),
                         2 * std::numbers::pi * hertz, random.Uniform(0, 2 * std::numbers::pi)};
    }
  }
}

double CameraPath::Shake(int axis, double time) const {
  double sum = 0;
  for (const Wave& wave : waves_[axis])
    sum += wave.amplitude * std::sin(wave.frequency * time + wave.phase);
  return sum;
}

PathKnot CameraPath::Spline(double time) const {
  const int count = static_cast<int>(knots_.size());
  const double s = time / period_ * count;
  const double whole = std::floor(s), f = s - whole;
  const double weights[4] = {(1 - f) * (1 - f) * (1 - f) / 6, (3 * f * f * f - 6 * f * f + 4) / 6,
                             (-3 * f * f * f + 3 * f * f + 3 * f + 1) / 6, f * f * f / 6};
  PathKnot at{Eigen::Vector3d::Zero(), 0, 0};
  for (int i = 0; i < 4; ++i) {
    const long index = static_cast<long>(whole) + i - 1;
    const long round = index >= 0 ? index / count : -((-index + count - 1) / count);
    const PathKnot& knot = knots_[static_cast<size_t>(index - round * count)];
    at.position += weights[i] * knot.position;
    at.yaw += weights[i] * (knot.yaw + 2 * std::numbers::pi * turns_ * static_cast<double>(round));
    at.pitch += weights[i] * knot.pitch;
  }
  return at;
}

// Speed rises from 0 to 1 within a second as 3 t² - 2 t³; its integral is t³ - t⁴/2.
double CameraPath::Walked(double time) const {
  if (timing_.turn_first == 0) return timing_.speed * time;
  const double since = std::max(0.0, time - timing_.turn_first);
  const double gone = since < 1 ? since * since * since * (1 - since / 2) : since - 0.5;
  return timing_.speed * gone;
}

Eigen::Vector3d CameraPath::UnshakenPosition(double time) const {
  return Spline(Walked(time)).position;
}

Se3 CameraPath::At(double time) const {
  PathKnot knot = Spline(Walked(time));
  double steady = 0;  // 1: no translation by shake
  if (timing_.turn_first > 0 && time < timing_.turn_first + 1) {
    const double since = std::max(0.0, time - timing_.turn_first);
    steady = 1 - since * since * (3 - 2 * since);
    if (time < timing_.turn_first) {
      const double wave = std::sin(std::numbers::pi * time / timing_.turn_first);
      knot.yaw += timing_.turn_angle * wave * wave;
    }
  }
  const Eigen::Vector3d shift(Shake(0, time), Shake(1, time), Shake(2, time));
  const Eigen::Vector3d turn(Shake(3, time), Shake(4, time), Shake(5, time));
  return {LookAlong(knot.yaw, knot.pitch) * ExpSo3(turn), knot.position + (1 - steady) * shift};
}

}  // namespace alidade
