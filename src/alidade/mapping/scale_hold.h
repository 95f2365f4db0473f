// Where one camera's scale is held, and where it is guessed. A new landmark's depth is to a known
// one's as the distance of the two keyframes it was made from is to their distance from what they
// know. While a camera turns on the spot that distance is a few centimetres, and a turn and a shift
// of them can hardly be told apart: all that is then mapped beside the known may come out at half
// its depth, and at half of that again in the next second.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/map/map_store.h"
#include "alidade/mapping/settings.h"

namespace alidade {

// Covariance of a keyframe's centre in the world: of a pose estimated from the landmarks it sees
// whose scale is known, taken as exact, with the noise of its keypoints. (Σ J' Σ⁻¹ J)⁻¹, its
// translation (Hartley & Zisserman 2004, 5.2). Huge where there are too few.
Eigen::Matrix3d CentreCovariance(const MapSnapshot& map, const KeyFrame& keyframe,
                                 const Camera& camera, const MeasurementNoise& noise);

// Those of the keyframe's best covisible ones (triangulate_keyframes_mono) whose distance from it
// is known: at least min_baseline_ratio of the median depth, with a standard deviation of at most
// max_baseline_error of it.
std::vector<KeyFrameId> AtKnownDistance(const MapSnapshot& map, const KeyFrame& keyframe,
                                        const Camera& camera, const MapperSettings& settings);

// Landmarks of the keyframe whose scale was not known and is now: also seen from `others`, and not
// made with an assumed depth.
std::vector<LandmarkId> ScaleFoundFrom(const MapSnapshot& map, const KeyFrame& keyframe,
                                       const std::vector<KeyFrameId>& others);

}  // namespace alidade
