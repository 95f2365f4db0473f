// Start of a map of one camera: two views triangulate its landmarks, then the next frames must
// confirm it. While the map is young, also checks for a stationary camera that watches a moving
// object (docs/development/decisions/0017-stationary-camera.md). Used by the driving thread.
#pragma once

#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "alidade/map/map_store.h"
#include "alidade/system/settings.h"
#include "alidade/system/workers/workers.h"
#include "alidade/tracking/mono_start.h"
#include "alidade/tracking/tracker.h"

namespace alidade {

class YoungMap {
 public:
  YoungMap(const Camera& camera, const SlamSettings& settings, Workers& workers);

  struct Begun {
    PlacedFrame placed;  // the frame, which is the second keyframe
    KeyFrameId id;       // of that keyframe
    MapSnapshot map;
    bool holds = false;  // enough landmarks; otherwise the map must be dropped
  };
  // Adds a frame while there is no map. If it starts a map with an earlier frame, both are in the
  // map as keyframes when this returns.
  std::optional<Begun> Begin(const std::shared_ptr<const Frame>& frame);
  TrackFailure failure() const { return start_.failure(); }  // why the last frame started no map
  void ForgetViews() { start_.Reset(); }  // drops the reference views for the next start

  // The newest map; invalid before the first one and after Drop().
  MapId map() const { return map_; }
  bool confirmed() const { return trial_left_ == 0; }
  // Counts a frame after the start; false if it contradicts the map. After start.trial_frames
  // frames the map is confirmed, and its two keyframes are passed to the workers.
  bool Confirm(const TrackEstimate& estimate);
  // Whether the frame is in the newest map and at most kYoung frames after its start. A map of a
  // moving object is dropped if it is young, kept otherwise. `reference`: the tracker's reference
  // keyframe.
  bool IsYoung(const Frame& frame, KeyFrameId reference, const MapSnapshot& map) const;
  // Whether frame `number` needs an edge thumbnail (Glance()), because the map is young.
  bool WantsGlance(int number) const { return started_ >= 0 && number - started_ <= kYoung; }
  // Adds a frame that was tracked in the young map. True if the camera is stationary: in at least
  // start.min_still_frames frames, and in most, landmarks have moved in the image since an earlier
  // view, but the image's edges have not.
  bool StandsStill(const PlacedFrame& placed);
  // At the end of input, for a young map: true if most frames, and at least a third of
  // start.min_still_frames, indicate a stationary camera.
  bool StoodStill() const {
    return still_ > moved_ && 3 * still_ >= settings_.start.min_still_frames;
  }
  // All frames from now on are of this camera; drops the views so far. `focal_sigma`: relative
  // standard deviation of its focal length.
  void SetCamera(const Camera& camera, double focal_sigma);
  void Drop();  // removes the newest map; frames tracked in it lose their poses

 private:
  static constexpr int kYoung = 40;       // frames
  static constexpr int kStillFrames = 8;  // largest distance of two frames that are compared

  using Pixels = std::map<LandmarkId, Eigen::Vector2d>;
  struct View {
    int number;      // Frame::number
    cv::Mat glance;  // edge thumbnail
    Pixels pixels;   // keypoints of the map's landmarks
  };
  // The newest view since which the landmarks, now at `now`, have moved by at least least_motion_
  // (median); null: none.
  const View* LastBeforeMotion(const Pixels& now, int number) const;

  SlamSettings settings_;
  Workers& workers_;
  MonoStart start_;
  int started_ = -1;         // number of the frame that started the map; -1: none
  int trial_left_ = 0;       // frames that must still confirm it
  int begun_points_ = 0;     // landmarks at its start
  MapId map_;                // see map()
  KeyFrameId keyframes_[2];  // its first two keyframes
  // The first keyframe and the frames since the start, the newest kStillFrames of them, newest
  // last. A thumbnail takes 170 kB.
  std::vector<View> views_;
  double least_motion_;  // pixels: start.min_still_motion times the image's width
  // Frames since the start whose image edges stayed where they were in an earlier view, and frames
  // whose edges moved.
  int still_ = 0, moved_ = 0;
};

}  // namespace alidade
