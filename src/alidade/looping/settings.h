// Settings of the loop closer. Counts of matches are for 1000 features; match_scale adapts them.
#pragma once

#include "alidade/base/api.h"
#include "alidade/map/adjust.h"
#include "alidade/map/reach.h"
#include "alidade/optimize/pose_graph.h"

namespace ALIDADE_API alidade {

struct LoopSettings {
  bool enabled = true;       // false: places are recognised only to relocalise
  MeasurementNoise noise{};  // of keypoints
  double match_scale = 1.0;  // multiplies the counts of matches below; phone 0.8

  // Candidates.
  int candidates = 3;        // places looked at for each keyframe, at most, in each map
  int group = 10;            // likest keyframes they are chosen from
  double score_share = 0.2;  // of the best covisible keyframe's score: what is less alike is no
                             // candidate (ORB-SLAM §VII-A)
  // Of the landmarks a keyframe sees: neighbours that share so many, and theirs, are tied to it
  // anyway and no candidates. One camera; with depth, where far landmarks hold the scale too, those
  // that share any. Measured on corridors: at 0 (any) two of five loops are missed, at 0.5
  // keyframes of one place close loops among themselves (ATE 2 to 7 cm).
  double tied_share = 0.2;
  // Radians between the optical axes, within a map: pictures of the same things taken further apart
  // than this (60 degrees, and what tracking may be off by: max_turn) match nowhere. Else the other
  // end of a corridor takes the place of this one among the candidates.
  double max_view_turn = 1.7;

  // Verification.
  int min_matches = 20;       // of descriptors alone
  int min_aligned = 15;       // of those, that agree on one alignment (Horn 1987)
  int min_found = 45;         // landmarks of the old place found where the alignment puts them
  int min_merge_found = 120;  // the same between two maps, where no way since speaks for or against
                              // it, and their whole relation hangs on it
  // Of the landmarks that have a keypoint at their very place, so many must look alike to it: where
  // only the shapes are the same (rooms of one make with other pictures), corners are where they
  // should be, but show something else. Measured: at most 0.38 there, 0.59 and more at the best
  // keyframe of one room, docs/development/decisions/0014-merge-by-appearance.md. Two maps only.
  double min_merge_alike = 0.45;
  int min_known_scale = 20;      // landmarks of known scale (Landmark::scale_known) both keyframes
                                 // must see for two maps of one camera to be merged
  double alike_radius = 2;       // pixels on level 0: 2.5 standard deviations of a keypoint's place
  double min_found_share = 0.1;  // of those that should be in sight: places only alike show less
  double search_radius = 8;      // pixels on level 0; the second time half of it
  int max_distance = 60;         // bits of 256
  int confirm_keyframes = 5;     // covisible keyframes that are asked, too …
  int confirm_needed = 2;        // … and how many must agree
  int confirm_found = 25;        // landmarks found in each of them
  // What tracking cannot have drifted by is no loop, however alike (doors of a corridor).
  double max_drift = 0.12;       // of the way since the old place was seen
  double max_drift_floor = 0.5;  // of the median depth, whatever the way
  double max_turn = 0.6;         // radians
  double max_plain_scale = 20;   // the same where the place is beyond doubt
  double max_scale = 1.7;        // monocular: between old and new place
  // Nor does a camera leap between two maps of one recording, or while it is lost (slam_lost.cc).
  ReachSettings reach;

  // Correction.
  int graph_shared = 100;  // landmarks two keyframes share to be tied in the pose graph
  PoseGraphSettings graph;
  // Of the whole map. What a loop leaves bends all of it a little, which damping would hold on to.
  BundleSettings bundle{
      .max_iterations = 15, .min_relative_decrease = 1e-5, .initial_lambda = 1e-6};
  uint64_t seed = 1;   // of the random samples
  void Check() const;  // throws Error (usage) naming the field that cannot be
};

}  // namespace alidade
