// Bundle adjustment of a part of the map.
#pragma once

#include <atomic>
#include <utility>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/geometry/camera.h"
#include "alidade/map/map_store.h"
#include "alidade/map/measurement.h"
#include "alidade/optimize/bundle_adjustment.h"

namespace ALIDADE_API alidade {

struct AdjustSettings {
  MeasurementNoise noise;  // of keypoints
  BundleSettings bundle;
  // One camera alone: its scale hangs on few observations where it turns past little structure, and
  // matches that are none bend it (a landmark k times too near weighs k²). So the loss follows the
  // noise there is: its bound is that for noise.sigma_px by the share of it that is seen (median of
  // chi² over that of noise as assumed, 2 ln 2), no smaller than this; and where that is below 1,
  // the loss is Geman & McClure's (BundleSettings::redescending). 1: Huber's loss, as assumed; so
  // after a loop, where the whole map is to move: from afar the other one lets the loop itself go.
  double min_noise_ratio = 1;
  // Landmarks of assumed depth (Landmark::depth_assumed) are held where they are to start with, by
  // a standard deviation of this share of their depth, as long as the rays from all keyframes that
  // see them are within so many degrees of the one from their reference. It is subject to the loss
  // as all else is. 0: adjusted as all others; so they would wander, by the noise alone.
  double assumed_depth_error = 0.5;
  double assumed_depth_degrees = 1;
};

struct Adjustment {
  Camera camera;  // and noise, with which it was computed
  MeasurementNoise noise;
  std::vector<std::pair<KeyFrameId, Se3>> poses;               // T_camera_world, by id
  std::vector<std::pair<LandmarkId, Eigen::Vector3d>> points;  // adjusted positions, world frame
  // Observations rejected by the chi² test.
  std::vector<std::pair<LandmarkId, KeyFrameId>> outliers;
  BundleReport report;
  // Covariance of `newest` (KeyFrame::covariance), if it was asked for.
  KeyFrameId newest;
  Matrix6d covariance = Matrix6d::Zero();
};

// Adjusts the poses of `free` and all landmarks they observe; the poses of `fixed` are constant.
// Both lists are sorted. `map` is not changed. `stop` (may be null) ends it early. `newest`: one of
// `free` whose covariance is wanted.
Adjustment AdjustKeyFrames(const MapSnapshot& map, const std::vector<KeyFrameId>& free,
                           const std::vector<KeyFrameId>& fixed, const Camera& camera,
                           const AdjustSettings& settings, const std::atomic<bool>* stop,
                           KeyFrameId newest = {});

// Applies the result to the objects that still exist. Objects created since `base` follow:
// keyframes the landmarks in them that `base` has, or, with fewer than 10, their parent; landmarks
// their reference keyframe.
void CommitAdjustment(MapCommit& commit, const MapSnapshot& base, const Adjustment& result);

}  // namespace alidade
