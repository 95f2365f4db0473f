// A keyframe of the map.
#pragma once

#include <memory>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/base/ids.h"
#include "alidade/features/frame.h"
#include "alidade/geometry/se3.h"
#include "alidade/map/depth_map.h"
#include "alidade/map/keyframe_motion.h"

namespace ALIDADE_API alidade {

struct Neighbour {
  KeyFrameId id;
  int shared = 0;  // landmarks observed by both
};

// Whether keyframes get a covariance. The module for browsers shows none and is limited in size.
#ifdef __EMSCRIPTEN__
inline constexpr bool kCovariances = false;
#else
inline constexpr bool kCovariances = true;
#endif

struct KeyFrame {
  KeyFrameId id;
  std::shared_ptr<const Frame> frame;  // never null in a map
  Se3 T_camera_world;
  MapId map;  // map whose world frame the pose refers to
  // Parent in the spanning tree, always the older of the two; none for the first keyframe of a map.
  KeyFrameId parent;
  // Product of all scale corrections of the lengths around it since its creation (loops of a
  // monocular map correct the scale).
  double scale = 1;
  // Covariance of the pose when it was the newest keyframe, relative to the oldest keyframe of its
  // local bundle adjustment: T_world_camera * Exp(xi) is the true pose, xi = (translation;
  // rotation) ~ N(0, covariance). Zero: unknown. Not saved with a map.
  Matrix6d covariance = Matrix6d::Zero();
  // Since the keyframe before, by an inertial sensor; null: unknown. Not saved with a map.
  std::shared_ptr<const KeyFrameMotion> motion;
  std::vector<KeyFrameId> loops;          // keyframes connected by loop closures, sorted
  std::vector<LandmarkId> landmarks;      // one per keypoint; invalid: none
  std::vector<Neighbour> covisible;       // by descending number of shared landmarks, then by id
  std::shared_ptr<const DepthMap> depth;  // semi-dense depth; null: not available (yet)
  uint64_t version = 0;                   // commit that last changed it

  // Camera center, world frame.
  Eigen::Vector3d Centre() const { return -(T_camera_world.R.transpose() * T_camera_world.t); }
};

}  // namespace alidade
