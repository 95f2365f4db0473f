// Settings of the loop closer. Counts of matches are for 1000 features; match_scale adapts them.
#pragma once

#include <span>

#include "alidade/base/api.h"
#include "alidade/map/adjust.h"
#include "alidade/map/reach.h"
#include "alidade/optimize/pose_graph.h"

namespace ALIDADE_API alidade {

struct Setting;

// Range, unit and meaning of the named fields: Table() in settings.cc.
struct LoopSettings {
  bool enabled = true;
  MeasurementNoise noise{};
  double match_scale = 1.0;

  // Candidates.
  int candidates = 3;
  // Keyframes with the most similar words, from which the candidates are chosen.
  int group = 10;
  // ORB-SLAM §VII-A.
  double score_share = 0.2;
  // At 0 loops in corridors are missed, at 0.5 keyframes of one place close loops among themselves
  // (decision 0013-loop-candidates).
  double tied_share = 0.2;
  // The field of view (60 degrees) and max_turn.
  double max_view_turn = 1.7;

  // Verification.
  int min_matches = 20;
  int min_aligned = 15;
  int min_found = 45;
  // Between two maps nothing else supports or contradicts the match.
  int min_merge_found = 120;
  // Rooms with the same furniture but different pictures have at most 0.38, one room at least 0.59
  // (decision 0014-merge-by-appearance).
  double min_merge_alike = 0.45;
  int min_known_scale = 20;
  // Pixels on level 0 within which a keypoint counts as being at a landmark's place: 2.5 standard
  // deviations of a keypoint.
  double alike_radius = 2;
  double min_visible_share = 0.1;
  double search_radius = 8;
  int max_distance = 60;
  int confirm_keyframes = 5;
  int confirm_needed = 2;
  int confirm_found = 25;
  // A loop may correct no more than tracking can have drifted by: corridors have doors that look
  // alike.
  double max_drift = 0.12;
  // Of the median depth: always allowed.
  double max_drift_floor = 0.5;
  double max_turn = 0.6;
  // Errors of a rotation grow with the rotation: 1 % of it where the focal length is known to 1 %.
  // Four times that.
  double turn_drift = 0.04;
  // Largest ratio of scales where the place is beyond doubt.
  double max_plain_scale = 20;
  double max_scale = 1.7;
  // Limits the motion between two maps of one recording and while the camera is lost.
  ReachSettings reach;

  // Correction.
  int graph_shared = 100;
  PoseGraphSettings graph;
  // Of the whole map. The error left by a loop is spread over all of it, which damping would slow.
  BundleSettings bundle{
      .max_iterations = 15, .min_relative_decrease = 1e-5, .initial_lambda = 1e-6};
  // Of the random samples; the system's.
  uint64_t seed = 1;

  static std::span<const Setting> Table();
  void Check() const;  // throws Error (usage) naming the invalid setting
};

}  // namespace alidade
