// A 3D point observed by keyframes.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/base/ids.h"
#include "alidade/features/descriptor.h"

namespace ALIDADE_API alidade {

struct Observation {
  KeyFrameId keyframe;
  int keypoint = -1;  // index in the keyframe
};

struct Landmark {
  LandmarkId id;
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();  // meters (mono: map units)
  std::vector<Observation> observations;              // sorted by keyframe
  KeyFrameId reference;  // keyframe it was created in, and which it follows in corrections
  uint64_t version = 0;  // commit that last changed it

  // Search data of tracking (Mur-Artal, Montiel & Tardós 2015, §III-C), updated by
  // RefreshLandmark().
  Descriptor descriptor;  // the observation with the smallest median distance to all others
  // Mean viewing direction from camera to landmark, unit length, world frame.
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  // Range of distances in which its scale is within the pyramid, meters.
  float min_distance = 0, max_distance = 0;

  // Probability of being static, 0 to 1; weight of its observations in poses and adjustments.
  float static_probability = 1;
  // Monocular: true if it was measured between keyframes whose baseline is known
  // (mapping/scale_hold.h). True for maps saved before 0.2.
  bool scale_known = true;
  // Its depth is an assumption, because it was created during a pure rotation (MapTurn()). False
  // for maps saved before 0.2.
  bool depth_assumed = false;
  // Newest keyframe at its creation; recent landmarks are on probation (mapping/cull.h).
  KeyFrameId born;
};

}  // namespace alidade
