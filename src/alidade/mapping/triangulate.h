// New landmarks by triangulation between keyframes.
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
  bool depth_assumed = false;  // created by MapTurn()
};

// True if the point projects to the keypoint: 95 % of chi² with 2 degrees of freedom.
bool FitsKeypoint(const Camera& camera, const KeyFrame& keyframe, const Keypoint& keypoint,
                  const Eigen::Vector3d& p_world, const MapperSettings& settings);

// Matches keypoints of `id` without a landmark along epipolar lines in its best covisible
// keyframes, and triangulates those with sufficient parallax and consistent reprojection and scale
// (Mur-Artal et al. 2015, §VI-C). Each keypoint is used at most once. Monocular: keyframes at a
// known distance come first, others are used only if necessary (MapperSettings::max_baseline_error,
// sufficient_known_scale).
std::vector<NewLandmark> TriangulateNew(const MapSnapshot& map, KeyFrameId id,
                                        const std::vector<KeyFrameId>& at_known_distance,
                                        const Camera& camera, const MapperSettings& settings);

}  // namespace alidade
