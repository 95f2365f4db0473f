// Settings of the mapper.
#pragma once

#include "alidade/base/api.h"
#include "alidade/map/measurement.h"
#include "alidade/optimize/bundle_adjustment.h"

namespace ALIDADE_API alidade {

struct MapperSettings {
  MeasurementNoise noise;    // of keypoints
  double match_scale = 1.0;  // multiplies counts of matches; phone 0.8

  // Landmarks from depth.
  // One view alone makes a landmark where one standard deviation of its depth is at most this share
  // of it (DepthErrorShare()): on KITTI up to 76 m, with a baseline of 11 cm and f = 525 px up to
  // 12 m. Farther ones wait until several views tell. All that is nearer helps: its disparity is
  // measured again in each view, and weighs as little as it says.
  double max_depth_error = 0.08;

  // Triangulation (ORB-SLAM §VI-C).
  int triangulate_keyframes_mono = 10;  // best covisible keyframes searched for partners
  int triangulate_keyframes_depth = 6;
  int triangulate_distance = 50;    // bits of 256: only the epipolar line guides the search
  double triangulate_ratio = 0.85;  // best to second-best distance
  // Between the two rays. Far points hold the rotation, their depth comes later. One camera needs
  // new points sooner: where it turns past a blank wall its scale hangs on what is mapped at once.
  double min_parallax_degrees = 0.4;
  double min_parallax_degrees_mono = 0.2;
  double min_baseline_ratio = 0.01;  // baseline to median depth, monocular
  // One camera: standard deviation of the distance of two keyframes by that distance, above which
  // it is not known, nor the scale of what is mapped from them. 0.02 to 0.05 are as good where a
  // camera turns before a wall; at 0.06 scale begins to break.
  double max_baseline_error = 0.04;
  // Landmarks of known scale a keyframe must see for nothing else to be mapped beside them.
  int enough_known_scale = 300;
  // Fewer do not hold a keyframe's scale. Where the camera has moved since by more than so much of
  // the median depth, and so many seconds have gone by, what was mapped from there on is split off
  // (MapCommit::Split()) and given up: the camera is found again at a known place, or begins
  // another map. What was mapped before stays: on the spot a camera's place is known though its
  // scale is not. A short while is bridged: a head that shakes comes back to what it knows.
  int min_known_scale = 20;
  double max_unknown_scale_seconds = 1.5;
  double max_unknown_scale_motion = 0.07;  // at 0.1 wrong poses stay, 0.05 loses frames

  // A camera that turns on the spot past little that is known (MapTurn()). By match_scale, too.
  int turn_landmarks = 60;  // with fewer in a keyframe, others without a depth are made; 0: never
  double turn_radius = 5;   // pixels on level 0 within which nothing else may look like it
  // While the rays from all that see one are within so many degrees of its reference keyframe's, it
  // is adjusted with its depth as it is, give or take a share of it: by the noise alone it would
  // wander, and all that hangs on it would shrink or blow up with it.
  double assumed_depth_error = 0.5;
  double assumed_depth_degrees = 1;

  // Fusion of duplicates.
  int fuse_keyframes = 15;   // covisible keyframes landmarks are projected into
  double fuse_radius = 3.0;  // pixels on level 0
  int fuse_distance = 50;    // bits of 256

  // Things that move. Where none are looked for, all landmarks count fully from the first.
  float young_static = 1;     // probability that a new landmark stands still; 0.5 with dynamics
  float least_static = 0.2f;  // below, a landmark is removed
  float sure_static = 0.9f;   // above, it counts fully

  // Culling (ORB-SLAM §VI-B, VI-E).
  double min_found_share = 0.25;  // found / expected sightings of a landmark on trial
  int trial_keyframes = 3;        // a landmark is on trial for as many keyframes after its own
  double redundant_share =
      0.9;  // of a keyframe's landmarks seen in 3 others at the same or a finer scale

  // Most keyframes alive, in all maps together; 0: no limit. Then the least useful go, a twentieth
  // of the limit at a time, since to choose them costs a look at the whole map. Memory, and the
  // time that loops take, follow the keyframes.
  int max_keyframes = 0;

  // Local bundle adjustment (ORB-SLAM §VI-D).
  // Adjusted: the newest and its best covisible ones. With fewer, a monocular scale breaks where
  // the camera turns round on the spot.
  int window_keyframes = 20;
  // On the spot few keyframes see the same as the newest. One camera's window is then filled with
  // those that share at least so many landmarks with one that is in it.
  int window_shared = 15;
  int window_iterations_mono = 20;  // bundle.max_iterations of one camera: a bend of scale is soft
  int window_fixed = 20;            // held: those that see most of the same landmarks
  double least_noise = 0.1;         // AdjustSettings::least_noise, one camera
  BundleSettings bundle{
      .max_iterations = 10, .min_relative_decrease = 1e-4, .initial_lambda = 1e-6};

  void Check() const;  // throws Error (usage) naming the field that cannot be
};

}  // namespace alidade
