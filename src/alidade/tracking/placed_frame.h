// A frame with its pose and landmark matches: the data passed between tracking steps.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "alidade/base/ids.h"
#include "alidade/features/frame.h"
#include "alidade/geometry/se3.h"

namespace alidade {

// A match with a temporary point that is not a landmark (PassingPoints).
struct PassingMatch {
  int keypoint = -1;
  int point = -1;  // index in PassingPoints
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();
};

// Of a frame that starts a map, whose pose is right by definition; whether the map is, its
// successors decide.
inline constexpr double kStartLogOdds = 5;

// A frame with its pose in the map.
struct PlacedFrame {
  std::shared_ptr<const Frame> frame;
  Se3 T_camera_world;
  std::vector<LandmarkId> matches;         // one per keypoint; invalid: none
  int inliers = 0;                         // matches consistent with the pose
  std::vector<PassingMatch> passing;       // temporary points used for the pose
  Matrix6d covariance = Matrix6d::Zero();  // of the pose (see PoseOnlyResult); zero: unknown
  double log_odds = kStartLogOdds;         // that the pose is right (PoseEvidence)
};

}  // namespace alidade
