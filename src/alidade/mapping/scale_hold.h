// Observability of the scale of a monocular map. The depth of a new landmark is proportional to the
// baseline of the two keyframes it was triangulated from, which is known only relative to existing
// landmarks. In a near-pure rotation the baseline is a few centimeters, and translation and
// rotation are hardly distinguishable: the depth of new landmarks may come out half as large, and
// half of that again in the next second.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/map/map_store.h"
#include "alidade/mapping/settings.h"

namespace alidade {

// Covariance of a keyframe's center in the world frame, for a pose estimated from its observations
// of landmarks with known scale (treated as exact) with the keypoints' noise: translation block of
// (Σ J' Σ⁻¹ J)⁻¹ (Hartley & Zisserman 2004, 5.2). Very large if there are too few.
Eigen::Matrix3d CentreCovariance(const MapSnapshot& map, const KeyFrame& keyframe,
                                 const Camera& camera, const MeasurementNoise& noise);

// The best covisible keyframes (up to triangulate_keyframes_mono) with a known baseline: at least
// min_baseline_ratio of the median depth, with a relative standard deviation of at most
// max_baseline_error.
std::vector<KeyFrameId> AtKnownDistance(const MapSnapshot& map, const KeyFrame& keyframe,
                                        const Camera& camera, const MapperSettings& settings);

// Landmarks of the keyframe whose scale becomes known: not known so far, also observed by one of
// `others`, and not created with an assumed depth.
std::vector<LandmarkId> ScaleFoundFrom(const MapSnapshot& map, const KeyFrame& keyframe,
                                       const std::vector<KeyFrameId>& others);

}  // namespace alidade
