// A point of the world that keyframes see.
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
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();  // metres (mono: map units)
  std::vector<Observation> observations;              // sorted by keyframe
  KeyFrameId reference;  // keyframe it was made in; it moves with that one
  uint64_t version = 0;  // commit that wrote it

  // What tracking needs to look for it (ORB-SLAM §III-C); kept by RefreshLandmark().
  Descriptor descriptor;  // the observation nearest to all others
  Eigen::Vector3f normal =
      Eigen::Vector3f::Zero();               // mean viewing direction, camera to landmark, unit
  float min_distance = 0, max_distance = 0;  // metres: where its scale is within the pyramid

  // How likely it stands still, 0…1: weighs what is seen of it in poses and adjustments.
  float static_probability = 1;
  // One camera: whether it was ever measured from keyframes whose distance from each other is known
  // (mapping/scale_hold.h). Not saved: those of a loaded map count as known.
  bool scale_known = true;
  bool depth_assumed = false;  // MapTurn() made it, that knows no depth. Not saved either
  KeyFrameId born;             // newest keyframe when it was made: young ones are on trial
};

}  // namespace alidade
