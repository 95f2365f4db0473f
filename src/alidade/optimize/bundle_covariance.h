// Covariances of the poses of a bundle problem that is at its optimum.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "alidade/optimize/bundle_adjustment.h"

namespace ALIDADE_API alidade {

// Covariance of the pose of the free camera `camera` where the problem is at its optimum:
// T_world_camera * Exp(xi) is the true pose, xi = (translation; rotation) ~ N(0, covariance). All
// free cameras and all points are unknown, so it is relative to the fixed cameras. Without images
// of a right camera and with one fixed camera nothing observes the scale: then the mean distance of
// the cameras from the fixed one is exact by definition. Scaled by the residuals. nullopt: not
// determined. Inverse of the reduced system (Triggs et al. 2000, §9).
std::optional<Matrix6d> CameraCovariance(const BundleProblem& problem,
                                         const BundleSettings& settings, int camera);

// The same of all cameras, relative to what they have in common: how far each is off after the
// solution was aligned with the truth. The alignment is a rigid motion, or a similarity without
// images of a right camera; it minimizes the sum of the squared errors of all cameras, in which a
// rotation of one radian weighs as much as `length` (map units). It is a change of the datum
// (Baarda's S-transformation; Förstner & Wrobel 2016, §4.5.3). No camera is fixed and there are no
// motions. Not scaled below the assumed noise if there are images of a right camera: disparities of
// one point have errors in common from view to view, which the residuals do not show (decision
// 0034). One per camera; zero: unknown. Empty: factoring would take more than `most_work`
// multiplications.
std::vector<Matrix6d> CameraCovariances(const BundleProblem& problem,
                                        const BundleSettings& settings, double length,
                                        double most_work = std::numeric_limits<double>::infinity());

}  // namespace alidade
