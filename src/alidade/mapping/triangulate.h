// New landmarks from keypoints two keyframes share but nobody knew.
#pragma once

#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/map/map_store.h"
#include "alidade/mapping/scale_hold.h"
#include "alidade/mapping/settings.h"

namespace alidade {

struct NewLandmark {
  Eigen::Vector3d p_world;
  Observation first, second;
  bool scale_known = true;
  bool depth_assumed = false;  // by MapTurn()
};

// Whether a point projects to where a keyframe has the keypoint: 95 % of chi² with 2 degrees of
// freedom.
bool FitsKeypoint(const Camera& camera, const KeyFrame& keyframe, const Keypoint& keypoint,
                  const Eigen::Vector3d& p_world, const MapperSettings& settings);

// Keypoints of `id` without a landmark, matched along epipolar lines in its best covisible
// keyframes and triangulated where parallax, reprojection and scale agree (ORB-SLAM §VI-C). A
// keypoint is used at most once. One camera: keyframes at a known distance come first, the
// others only where they must (MapperSettings::max_baseline_error, enough_known_scale).
std::vector<NewLandmark> TriangulateNew(const MapSnapshot& map, KeyFrameId id,
                                        const std::vector<KeyFrameId>& at_known_distance,
                                        const Camera& camera, const MapperSettings& settings);

}  // namespace alidade
