// Initialization of a monocular map: searches for a pair of frames with sufficient parallax. Keeps
// several reference frames, so that a bad one (blurred, or before a rotation) does not delay the
// start.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/features/frame.h"
#include "alidade/features/matching.h"
#include "alidade/geometry/two_view.h"
#include "alidade/tracking/track_failure.h"

namespace ALIDADE_API alidade {

struct MonoStartSettings {
  TwoViewSettings two_view;
  // With depth: landmarks the first frame must give, of 1000 features; ten times what a frame must
  // find again (tracker.min_tracked).
  int min_depth_landmarks = 200;
  int min_matches = 100;  // for 1000 features; with the reference frame, below which it is given up
  double match_scale = 1.0;  // multiplies counts of matches; phone 0.8
  int references = 4;        // kept at a time, at most
  int reference_gap = 6;     // frames between them
  double window = 0.16;      // of the image's width: how far a keypoint may move between two frames
  // Of the image's width: median motion below which a pair is not tried. Only saves time: what a
  // pair can tell is for the two views to say.
  double min_motion = 0.0075;
  // A camera that stands still while something moves before it takes the thing for a place it moves
  // past: two views cannot tell. But the rest of the picture stays where it was to a fraction of a
  // pixel, which a moving camera shows only by chance. Refused when at least `max_still_share` of
  // the matches moved by less than `still_pixels`, `min_still_peak` times as many as by one to two
  // times that (around a chance meeting of motions there are as many or more: 0.2 to 0.8 in videos;
  // a still camera has 1.3 before slow hands in a small picture, 4 to 20 else), and these lie about
  // in at least `min_still_area` of the area of the others: what is fixed to the camera (a bonnet,
  // a caption) is in one place.
  double still_pixels = 1.0;
  double max_still_share = 0.1;
  double min_still_peak = 1.2;
  double min_still_area = 0.4;
  // Keypoints may all be on the thing. Refused, too, when this share of the picture's edges stays
  // in each direction (StillShare() in features/glance.h): where a camera starts to move 0 to 0.09
  // do, before a camera on a tripod 0.15 to 0.6.
  double max_still_picture = 0.13;
  // What moves hides the rest now and then: after a pair was refused for that, none of the next so
  // many frames begins a map.
  int still_memory = 10;
  // The same is asked of each frame of a young map and the last one before it since which landmarks
  // have moved by so much of the image's width (median): it is given up when so many of these
  // frames, and more than half of them, show the picture of that one again; at a recording's end
  // a third of so many do.
  double min_still_motion = 0.0075;
  int min_still_frames = 12;
  int trial_frames = 5;      // frames that must confirm the map before it is believed
  double trial_share = 0.3;  // of its points that should be in sight, tracked in each of them
  void Check() const;        // throws Error (usage) naming the field that cannot be
};

struct MonoStartResult {
  std::shared_ptr<const Frame> a, b;
  Se3 T_b_a;  // |t| = 1
  struct Point {
    // In the frame of a.
    Eigen::Vector3d p_a;
    int keypoint_a, keypoint_b;
  };
  std::vector<Point> points;
  double parallax_degrees = 0;
};

class MonoStart {
 public:
  MonoStart(const Camera& camera, MonoStartSettings settings);
  // Adds a frame. Returns a result if it and an earlier frame determine a two-view reconstruction.
  std::optional<MonoStartResult> Add(std::shared_ptr<const Frame> frame);
  void Reset() { references_.clear(); }
  // Why the last frame did not start a map: the furthest step that any of its pairs reached.
  TrackFailure failure() const;

 private:
  struct Reference {
    std::shared_ptr<const Frame> frame;
    std::vector<Eigen::Vector2f> guess;  // last observed position of each keypoint
  };
  // Progress of a pair, and what stopped it.
  enum class Step {
    kNoFrame,
    kFewCorners,
    kFewMatches,
    kLittleMotion,
    kNoModel,
    kLowParallax,
    kUnknownLens,
    kAmbiguous,
    kStillCamera,
    kStarts
  };
  static Step StepOf(TwoViewFailure failure);
  // True if too many matches stay in place (see settings).
  bool StandsStill(std::span<const Eigen::Vector2d> a, std::span<const Eigen::Vector2d> b) const;
  bool PictureStays(const Frame& a, const Frame& b) const;
  Step Try(Reference& reference, const std::shared_ptr<const Frame>& frame,
           MonoStartResult& result) const;

  Camera camera_;
  MonoStartSettings settings_;
  std::vector<Reference> references_;  // oldest first
  Step farthest_ = Step::kNoFrame;     // of the last frame's pairs
  // Number of the last frame for which a pair was rejected because of a stationary camera.
  std::optional<int> still_;
};

}  // namespace alidade
