// Settings of the mapper.
#pragma once

#include <span>

#include "alidade/base/api.h"
#include "alidade/map/measurement.h"
#include "alidade/optimize/bundle_adjustment.h"

namespace ALIDADE_API alidade {

struct Setting;

// Range, unit and meaning of the named fields: Table() in settings.cc.
struct MapperSettings {
  MeasurementNoise noise;
  double match_scale = 1.0;

  // Landmarks from depth.
  // Relative standard deviation (DepthErrorShare()); farther landmarks wait for several views. Near
  // ones help even when imprecise: each view measures their disparity again, weighted by its noise.
  double max_depth_error = 0.08;

  // Triangulation (ORB-SLAM §VI-C).
  int triangulate_keyframes_mono = 10;
  int triangulate_keyframes_depth = 6;
  // Only the epipolar line guides the search.
  int triangulate_distance = 50;
  // Highest ratio of best to second-best descriptor distance.
  double triangulate_ratio = 0.85;
  // Far points constrain the rotation; their depth improves later.
  double min_parallax_degrees = 0.4;
  // One camera needs new points sooner: in a rotation past a blank wall its scale depends on what
  // is mapped at once.
  double min_parallax_degrees_mono = 0.2;
  double min_baseline_ratio = 0.01;
  // From 0.06 on, scale breaks (decision 0010-scale-in-rotation).
  double max_baseline_error = 0.04;
  // Landmarks of known scale in a keyframe, above which none of unknown scale are added.
  int sufficient_known_scale = 300;
  int min_known_scale = 20;
  double max_unknown_scale_seconds = 1.5;
  // At 0.1 wrong poses remain, at 0.05 frames are lost.
  double max_unknown_scale_motion = 0.07;

  // Pure rotation past few landmarks (MapTurn()). Scaled by match_scale.
  int rotation_landmarks = 60;
  // Pixels on level 0 within which no other keypoint may have a similar descriptor.
  double turn_radius = 5;
  // Depth prior of landmarks with little parallax in bundle adjustment. Without it their depth is
  // unconstrained and scale drifts (decision 0011-landmarks-of-assumed-depth).
  double assumed_depth_error = 0.5;
  double assumed_depth_degrees = 1;

  // Fusion of duplicates.
  int fuse_keyframes = 15;
  double fuse_radius = 3.0;
  // Largest descriptor distance, bits of 256.
  int fuse_distance = 50;

  // Moving objects. Without dynamics, all landmarks count fully from the first.
  // Probability that a new landmark is static; 0.5 with dynamics.
  float young_static = 1;
  // Probability below which a landmark is removed.
  float least_static = 0.2f;
  // Probability above which it counts fully.
  float sure_static = 0.9f;

  // Culling (ORB-SLAM §VI-B, VI-E).
  double min_observed_share = 0.25;
  int trial_keyframes = 3;
  double redundant_share = 0.9;

  // Above it, the least useful are removed, a twentieth of the limit at a time: choosing them costs
  // a pass over the whole map. Memory and the time of loops follow the number of keyframes.
  int max_keyframes = 0;

  // Local bundle adjustment (ORB-SLAM §VI-D).
  // With fewer, a monocular scale breaks in pure rotation.
  int window_keyframes = 20;
  int window_shared = 15;
  // Of one camera: errors of scale converge slowly.
  int window_iterations_mono = 20;
  int window_fixed = 20;
  double min_noise_ratio = 0.1;
  BundleSettings bundle{
      .max_iterations = 10, .min_relative_decrease = 1e-4, .initial_lambda = 1e-6};

  static std::span<const Setting> Table();
  void Check() const;  // throws Error (usage) naming the invalid setting
};

}  // namespace alidade
