// Measured positions and where a trajectory is at their times.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "alidade/io/trajectory.h"
#include "alidade/run/world/positions_table.h"

namespace alidade {

struct PositionPair {
  Eigen::Vector3d map = Eigen::Vector3d::Zero();       // of the camera in the trajectory's world
  Eigen::Vector3d measured = Eigen::Vector3d::Zero();  // as measured
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // of `map`, per second
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();     // T_world_camera.R
  double time = 0;                                     // of the trajectory, seconds
};
using PositionPairs = std::vector<PositionPair>;

// A trajectory between its poses: straight, with even rotation.
class PathAt {
 public:
  explicit PathAt(const Trajectory& trajectory) : trajectory_(trajectory) {}  // kept by reference
  // Without `measured`. nullopt: outside, or between poses more than half a second apart.
  std::optional<PositionPair> At(double time) const;

 private:
  const Trajectory& trajectory_;
};

// Of the positions that have a match; `offset`: of their clock, seconds.
PositionPairs PairsAt(const PathAt& path, const std::vector<TimedPosition>& positions,
                      double offset);

}  // namespace alidade
