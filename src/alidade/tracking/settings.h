// Settings of the tracker. Counts of matches are for 1000 features; match_scale adapts them.
#pragma once

#include "alidade/base/api.h"
#include "alidade/features/extractor.h"
#include "alidade/map/measurement.h"
#include "alidade/tracking/motion.h"

namespace ALIDADE_API alidade {

struct TrackerSettings {
  ExtractorSettings extractor;
  double match_scale =
      1.0;                 // multiplies the counts of matches below; phone 0.8 (half the features)
  int min_predicted = 20;  // matches with the last frame, below which the search is widened
  int min_after_prediction = 10;   // inliers, below which the reference keyframe is tried instead
  int min_tracked = 20;            // inliers with the local map, below which the frame is lost
  double min_found_share = 0.085;  // inliers, of the landmarks that should be in sight; below, the
                                   // frame is lost: right poses show twice as many at the least
  double torn_share = 0.33;  // inliers, of the last frame's; below, the pose is only believed as
                             // one found when lost is: the recording may have been cut
  // With depth: so many frames after a start, or after a place was found again, motion is not yet
  // believed:
  // nothing is known of speed, and near a wrong place much of what is far agrees with it. Then
  // descriptors are compared over the whole picture, too, and the pose that more of the map agrees
  // with is taken.
  int unproven_frames = 5;
  // Seconds without a placed frame after which motion is not believed either, with or without
  // depth: hands may have turned by 20 degrees meanwhile, and so far off some of the last frame's
  // matches still agree on a pose (kitchen with 3 % of its frames .1 to 1 s late: ATE 3.6 to 24 cm
  // without in 28 runs, 3.6 to 4.2 with in 16) …
  double unproven_seconds = 0.2;
  // … and how well, on average, matches then must fit for the pose to be believed: 1 without error,
  // 0 at the gate of 95 %. Right poses have .4 to .8, wrong ones .15 to .3.
  double min_late_agreement = 0.3;
  double min_agreement =
      0.4;                 // share of a frame's matches that must fit one pose for it to be trusted
  int max_distance = 100;  // bits of 256; with a pose to guide the search
  double local_ratio = 0.8;            // best to second-best descriptor distance on the same level
  float last_frame_radius = 15;        // pixels on level 0 around the predicted place, monocular
  float last_frame_radius_depth = 10;  // the same with depth: the prediction is better
  float local_radius = 4;  // pixels on level 0, seen from the side; 0.625 of it head-on (ORB-SLAM)
  float local_radius_depth =
      12;  // the same with depth, whose landmarks are placed from a single view
  float relocalise_radius = 10;  // pixels on level 0, around a place found by descriptors alone
  int min_relocalised = 40;      // inliers for a place to be believed when lost …
  double min_relocalised_share = 0.15;  // … and their share of the landmarks that should be seen
  double min_relocalised_spread = 0.1;  // … and how far apart they are in the picture: root mean
                                        // square distance from their middle, of its diagonal
  int local_keyframes = 40;             // at most, in the local map
  // A depth camera's own range, metres; what it says of farther places is no reading. 8 is what
  // structured light and time of flight reach in rooms. Stereo pairs have none: their noise says
  // how far (mapper.max_depth_error).
  double depth_range = 8.0;
  MeasurementNoise noise{.sigma_px = 1.0};  // of keypoints
  double good_agreement =
      0.7;  // share of matches that fit one pose, below which a frame is taken as bent …
  double bad_frame_sigma = 3.0;  // … and the noise of its keypoints as so many times larger
  // A keyframe is asked for when a frame's inliers fall below this share of the most since the last
  // one …
  double keyframe_share_mono = 0.9;
  double keyframe_share_depth = 0.8;
  int keyframe_min_gap = 1;   // … but not sooner after the last than this many frames,
  int keyframe_max_gap = 30;  // and at the latest after this many
  MotionSettings motion;      // how the camera is taken to move on
  // Seconds a lost camera is taken to go on as it moved: so long its pose is told as predicted, and
  // looked for there. Hands turn back within a second.
  double predict_seconds = 0.5;
  uint64_t seed = 1;   // of the random samples when a frame is placed anew
  void Check() const;  // throws Error (usage) naming the field that cannot be
};

}  // namespace alidade
