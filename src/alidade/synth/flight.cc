#include "alidade/synth/flight.h"

#include <algorithm>
#include <utility>

#include "alidade/base/error.h"

namespace alidade {

using Eigen::Vector3d;

void Flight::Check() const {
  if (poses.size() < 2) ThrowUsage("flight: the path needs two poses or more");
  for (size_t i = 1; i < poses.size(); ++i) {
    if (!(poses[i].time > poses[i - 1].time))
      ThrowUsage("flight: the poses of the path are not in order of time");
  }
  for (size_t i = 1; i < readings.size(); ++i) {
    if (!(readings[i].time > readings[i - 1].time))
      ThrowUsage("flight: the inertial readings are not in order of time");
  }
  imu.Check();
}

double Flight::Fps() const {
  std::vector<double> intervals;
  for (size_t i = 1; i < poses.size(); ++i) intervals.push_back(poses[i].time - poses[i - 1].time);
  const auto middle = intervals.begin() + static_cast<long>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return 1 / *middle;
}

FlightPath::FlightPath(std::vector<FlightPose> poses)
    : poses_(std::move(poses)),
      velocity_(poses_.size(), Vector3d::Zero()),
      angular_rate_(poses_.size(), Vector3d::Zero()) {
  // The derivative of the parabola through three poses; 0 at the ends.
  for (size_t i = 1; i + 1 < poses_.size(); ++i) {
    const FlightPose &a = poses_[i - 1], &b = poses_[i], &c = poses_[i + 1];
    const double before = b.time - a.time, after = c.time - b.time, all = before + after;
    const Eigen::Matrix3d R = b.T_world_camera.R.transpose();
    velocity_[i] = (b.T_world_camera.t - a.T_world_camera.t) * (after / before / all) +
                   (c.T_world_camera.t - b.T_world_camera.t) * (before / after / all);
    angular_rate_[i] = -LogSo3(R * a.T_world_camera.R) * (after / before / all) +
                       LogSo3(R * c.T_world_camera.R) * (before / after / all);
  }
}

Se3 FlightPath::At(double time) const {
  if (time <= poses_.front().time) return poses_.front().T_world_camera;
  if (time >= poses_.back().time) return poses_.back().T_world_camera;
  const auto next =
      std::upper_bound(poses_.begin(), poses_.end(), time,
                       [](double at, const FlightPose& pose) { return at < pose.time; });
  const size_t j = static_cast<size_t>(next - poses_.begin()), i = j - 1;
  const Se3 &a = poses_[i].T_world_camera, &b = poses_[j].T_world_camera;
  const double dt = poses_[j].time - poses_[i].time, s = (time - poses_[i].time) / dt;
  // Hermite's polynomials of values and slopes at both ends; here the first value is 0.
  const double end = s * s * (3 - 2 * s), slope_a = s * (1 - s) * (1 - s),
               slope_b = s * s * (s - 1);
  const Vector3d turn = LogSo3(a.R.transpose() * b.R);
  const Vector3d turned = end * turn + slope_a * dt * angular_rate_[i] +
                          slope_b * dt * (InverseRightJacobian(turn) * angular_rate_[j]);
  const Vector3d moved =
      end * (b.t - a.t) + slope_a * dt * velocity_[i] + slope_b * dt * velocity_[j];
  return {a.R * ExpSo3(turned), a.t + moved};
}

RecordedImu::RecordedImu(std::vector<ImuSample> readings, const ImuModel& model)
    : readings_(std::move(readings)) {
  told_ = truth_ = model;
}

std::vector<ImuSample> RecordedImu::Between(double after, double until) const {
  const auto later = [](double time, const ImuSample& sample) { return time < sample.time; };
  return {std::upper_bound(readings_.begin(), readings_.end(), after, later),
          std::upper_bound(readings_.begin(), readings_.end(), until, later)};
}

}  // namespace alidade
