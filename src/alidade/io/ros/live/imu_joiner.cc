#include "alidade/io/ros/live/imu_joiner.h"

#include <algorithm>

#include "alidade/inertial/imu_stream.h"

namespace alidade {
namespace {

constexpr size_t kMostUnjoined = 10000;  // of a sensor whose partner is silent

void AddInOrder(const ImuSample& sample, std::vector<ImuSample>& samples) {
  if (!samples.empty() && sample.time <= samples.back().time) return;
  if (samples.size() >= kMostUnjoined)
    samples.erase(samples.begin(), samples.begin() + kMostUnjoined / 2);
  samples.push_back(sample);
}

}  // namespace

void ImuJoiner::AddRate(double time, const Eigen::Vector3d& angular_rate) {
  AddInOrder({time, angular_rate, Eigen::Vector3d::Zero()}, rates_);
}

void ImuJoiner::AddForce(double time, const Eigen::Vector3d& specific_force) {
  AddInOrder({time, Eigen::Vector3d::Zero(), specific_force}, forces_);
}

std::vector<ImuSample> ImuJoiner::Take() {
  if (rates_.empty() || forces_.empty()) return {};
  const std::vector<ImuSample> joined = OnOneClock(rates_, forces_);
  const auto later_than = [](double time) {
    return [time](const ImuSample& sample) { return sample.time > time; };
  };
  const auto waiting = std::find_if(rates_.begin(), rates_.end(), later_than(forces_.back().time));
  rates_.erase(rates_.begin(), waiting);
  // The last acceleration is the one before the next reading.
  forces_.erase(forces_.begin(), forces_.end() - 1);
  return joined;
}

}  // namespace alidade
