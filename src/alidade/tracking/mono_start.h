// How a map begins from one moving camera, with no target: wait for two views that tell.
// Several reference frames are kept, so that a bad one (blurred, or before a turn) costs nothing.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/features/frame.h"
#include "alidade/features/matching.h"
#include "alidade/geometry/two_view.h"

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
  double min_motion = 0.015;  // of the image's width: median motion below which a pair can't tell
  int trial_frames = 5;       // frames that must confirm the map before it is believed
  double trial_share = 0.3;   // of its points, tracked in each of them
  void Check() const;         // throws Error (usage) naming the field that cannot be
};

struct MonoStartResult {
  std::shared_ptr<const Frame> a, b;
  Se3 T_b_a;  // |t| = 1
  struct Point {
    Eigen::Vector3d p_a;
    int keypoint_a, keypoint_b;
  };
  std::vector<Point> points;
  double parallax_degrees = 0;
};

class MonoStart {
 public:
  MonoStart(const Camera& camera, MonoStartSettings settings);
  // The next frame; a result once it and an earlier one tell where the points are.
  std::optional<MonoStartResult> Add(std::shared_ptr<const Frame> frame);
  void Reset() { references_.clear(); }
  const char* reason() const { return reason_; }  // why the last frame did not start a map

 private:
  struct Reference {
    std::shared_ptr<const Frame> frame;
    std::vector<Eigen::Vector2f> guess;  // where each keypoint was last seen
  };
  std::optional<MonoStartResult> Try(Reference& reference,
                                     const std::shared_ptr<const Frame>& frame, bool& lost);

  Camera camera_;
  MonoStartSettings settings_;
  std::vector<Reference> references_;  // oldest first
  const char* reason_ = "no frame yet";
};

}  // namespace alidade
