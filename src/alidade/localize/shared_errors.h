// Covariance of a pose whose landmarks have errors in common.
#pragma once

#include "alidade/geometry/camera.h"
#include "alidade/map/map_store.h"
#include "alidade/map/measurement.h"
#include "alidade/tracking/placed_frame.h"

namespace alidade {

// Landmarks of one reference keyframe share the error of its pose and, with depth, of its sensor.
// Their residuals are then not independent, and J^T W J tells too small a covariance. The estimate
// that is robust to clusters (Liang & Zeger 1986) uses, with H = sum of J^T W J and the sum s_g of
// J^T W r over the matches of keyframe g of G:
//   covariance = G / (G - 1) H⁻¹ (sum of s_g s_g^T) H⁻¹.
// Of the left increment of T_camera_world, as PoseOnlyResult::covariance. With few keyframes it is
// singular. Zero: fewer than two keyframes, or an undetermined pose.
Matrix6d SharedErrors(const PlacedFrame& placed, const Camera& camera, const MapSnapshot& map,
                      const MeasurementNoise& noise);

}  // namespace alidade
