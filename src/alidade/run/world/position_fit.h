// Aligns a trajectory with measured positions: a similarity, and the offset of the two clocks.
//
// Robust start by least trimmed squares over hypotheses of three positions each, for every offset
// of the clocks that is tried (Rousseeuw & Van Driessen 2006); then least squares over the
// positions that agree, with the covariance of the normal equations.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "alidade/io/trajectory.h"
#include "alidade/run/world/positions_table.h"

namespace alidade {

struct PositionFitSettings {
  // An image taken at t was taken at t + time_offset on the clock of the positions, seconds;
  // nullopt: estimated.
  std::optional<double> time_offset;
  // Of the trajectory's world: direction in which things fall, where that is known. It is used if
  // the positions alone do not tell the rotation; z of the positions' world is up then.
  std::optional<Eigen::Vector3d> down;
  double down_sigma = 0.01;  // radians
  bool meters = false;       // the scale is known to be 1: it is not estimated
  Eigen::Vector3d antenna = Eigen::Vector3d::Zero();  // of the receiver in the camera's frame, m
};

struct PositionFit {
  std::string why_not;  // why there is no alignment, with figures, as a sentence; empty: there is
  Sim3 T_positions_world;
  double scale_sigma = 0;                         // relative
  double rotation_sigma = 0;                      // radians, of the worst axis
  double tilt_sigma = 0;                          // radians, of the direction of z
  double time_offset = 0, time_offset_sigma = 0;  // seconds; sigma 0: given
  bool by_gravity = false;                        // PositionFitSettings::down was needed
  int matched = 0;                                // positions while the trajectory has poses
  std::vector<double> residuals;                  // of `matched`, meters, in order of time
  std::vector<double> times;                      // of them, on the clock of the trajectory
  std::vector<Eigen::Vector3d> positions;         // of them
  std::vector<bool> used;                         // of them: others are outliers
  int used_count() const;
  // Of the residuals of the used ones, 0 <= share <= 1; 1: the worst.
  double Quantile(double share) const;
};

// `trajectory` in order of time. Positions between poses more than half a second apart have no
// match.
PositionFit FitPositions(const Trajectory& trajectory, const std::vector<TimedPosition>& positions,
                         const PositionFitSettings& settings);

}  // namespace alidade
