// A frame with its pose and the landmarks it shows: what tracking passes along.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "alidade/base/ids.h"
#include "alidade/features/frame.h"
#include "alidade/geometry/se3.h"

namespace alidade {

// A keypoint that shows a point which is no landmark, and stays out of the map.
struct PassingMatch {
  int keypoint = -1;
  int point = -1;  // index, as PassingPoints has it
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();
};

// A frame placed in the map.
struct PlacedFrame {
  std::shared_ptr<const Frame> frame;
  Se3 T_camera_world;
  std::vector<LandmarkId> matches;         // one for each keypoint; none where nothing is known
  int inliers = 0;                         // matches that agree with the pose
  std::vector<PassingMatch> passing;       // what else has a say in the pose
  Matrix6d covariance = Matrix6d::Zero();  // of the pose (PoseOnlyResult); zero: not known
};

}  // namespace alidade
