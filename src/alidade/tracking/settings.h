// Settings of the tracker. Counts of matches are for 1000 features; match_scale adapts them.
#pragma once

#include <span>

#include "alidade/base/api.h"
#include "alidade/features/extractor.h"
#include "alidade/map/measurement.h"
#include "alidade/tracking/motion.h"
#include "alidade/tracking/pose_evidence.h"

namespace ALIDADE_API alidade {

struct Setting;

// Range, unit and meaning of the named fields: Table() in settings.cc.
struct TrackerSettings {
  ExtractorSettings extractor;
  double match_scale = 1.0;
  int min_predicted = 20;
  int min_after_prediction = 10;
  int min_tracked = 20;
  // Where a moving object hides nearly the whole image, what is found may be of the object.
  double min_inlier_share = 0.085;
  // With depth. After a start or a relocalization the speed is unknown, and near a wrong place many
  // far landmarks still agree.
  int unconfirmed_frames = 5;
  // Hands can turn a camera by 20 degrees in that time (decision 0023-late-frames).
  double max_motion_age = 0.2;
  double min_agreement = 0.4;
  int max_distance = 100;
  // Highest ratio of best to second-best descriptor distance on the same level.
  double local_ratio = 0.8;
  float last_frame_radius = 15;
  // The prediction is better with depth.
  float last_frame_radius_depth = 10;
  // Seen from the side; 0.625 of it head-on (ORB-SLAM).
  float local_radius = 4;
  // Landmarks with depth are placed from a single view.
  float local_radius_depth = 12;
  // Pixels on level 0, search radius around a place found by descriptors alone.
  float relocalize_radius = 10;
  // Matches in a small region (one poster) do not tell translation from rotation.
  double min_relocalized_spread = 0.1;
  int local_keyframes = 40;
  // The range of structured light and time of flight in rooms. Stereo pairs have no such limit:
  // their noise decides (mapper.max_depth_error).
  double depth_range = 8.0;
  MeasurementNoise noise{.sigma_px = 1.0};
  // A frame with a smaller share of matches that fit one pose counts as distorted (rolling shutter,
  // blur); the noise of its keypoints is multiplied by bad_frame_sigma.
  double good_agreement = 0.7;
  double bad_frame_sigma = 3.0;
  double keyframe_share_mono = 0.9;
  double keyframe_share_depth = 0.8;
  // Frames between keyframes are aligned with the last extracted one (Tracker::Align()).
  bool align = true;
  int min_keyframe_gap = 1;
  int max_keyframe_gap = 30;
  MotionSettings motion;
  PoseEvidenceSettings evidence;
  // Hands turn a camera back within a second.
  double predict_seconds = 0.5;
  // Of the random samples of a relocalization; the system's.
  uint64_t seed = 1;

  static std::span<const Setting> Table();
  void Check() const;  // throws Error (usage) naming the invalid setting
};

}  // namespace alidade
