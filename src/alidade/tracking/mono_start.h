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

struct Setting;

// Range, unit and meaning of the named fields: Table() in mono_start.cc.
struct MonoStartSettings {
  TwoViewSettings two_view;
  int min_depth_landmarks = 200;
  int min_matches = 100;
  double match_scale = 1.0;
  // Reference frames kept at a time.
  int references = 4;
  int reference_gap = 6;
  double window = 0.16;
  // Share of the image width: a pair with less median motion is not tried, which saves time.
  double min_motion = 0.0075;
  // Behind a moving object a stationary camera must not start a map: two views cannot tell the two
  // apart, but the background stays in place within a fraction of a pixel. A pair is refused when
  // at least max_still_share of the matches moved by less than still_pixels (pixels),
  // min_still_peak times as many as by one to two times that, and these cover at least
  // min_still_area of the area of the others: what is fixed to the camera (a hood, a caption) is in
  // one place. The peak is 0.2 to 0.8 in videos of moving cameras, 1.3 to 20 with a stationary one
  // (decision 0017-stationary-camera).
  double still_pixels = 1.0;
  double max_still_share = 0.1;
  double min_still_peak = 1.2;
  double min_still_area = 0.4;
  // All keypoints may lie on the object. 0 to 0.09 of the image edges stay in place where a camera
  // starts to move, 0.15 to 0.6 with a camera on a tripod (StillShare() in features/glance.h).
  double max_still_picture = 0.13;
  // Frames after such a refusal in which no map starts: the object sometimes covers the background.
  int still_memory = 10;
  // An unconfirmed map is tested in the same way against the last frame since which landmarks have
  // moved by min_still_motion. At the end of a recording a third of min_still_frames suffices.
  double min_still_motion = 0.0075;
  int min_still_frames = 12;
  int trial_frames = 5;
  double trial_share = 0.3;
  static std::span<const Setting> Table();
  void Check() const;  // throws Error (usage) naming the invalid setting
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
