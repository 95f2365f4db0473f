// Where the camera is at this frame, from the map as it stands. Reads the map, never writes it.
// ORB-SLAM §V (Mur-Artal, Montiel & Tardós 2015), with depth as in ORB-SLAM2 (2017).
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "alidade/map/anchor.h"
#include "alidade/map/map_store.h"
#include "alidade/optimize/pose_only.h"
#include "alidade/tracking/local_map.h"
#include "alidade/tracking/motion.h"
#include "alidade/tracking/passing_points.h"
#include "alidade/tracking/placed_frame.h"
#include "alidade/tracking/readout.h"
#include "alidade/tracking/settings.h"

namespace alidade {

struct SightingCount {
  LandmarkId landmark;
  bool found = false;  // expected in the frame, and: was it matched?
};

struct TrackEstimate {
  bool tracked = false;
  PlacedFrame placed;
  KeyFrameId reference;                  // keyframe that shares most landmarks with the frame
  std::vector<SightingCount> sightings;  // landmarks that should have been seen
  bool wants_keyframe = false;
};

class Tracker {
 public:
  // `camera`: as the frames are; with depth_factor and baseline 0 for monocular use.
  Tracker(const Camera& camera, TrackerSettings settings);

  // Turns images into a frame. `right` and `depth` may be empty. `avoid`: see Extractor.
  std::shared_ptr<Frame> Extract(const cv::Mat& image, const cv::Mat& right, const cv::Mat& depth,
                                 double time, int number, const cv::Mat& avoid = {});
  // Of the camera, from the next frame on; see Camera.
  void SetReadout(const std::array<double, 2>& readout) { camera_.readout = readout; }
  // All frames from now on, and what is kept of the last one.
  void SetCamera(const Camera& camera);
  // Rolling shutters only: keypoints as if read all at once, by how the camera is taken to move.
  void UndoShutter(Frame& frame, const MapSnapshot& map) const;
  // The same of a frame that was placed, by how it did move, and its pose with that. `frame` is the
  // estimate's.
  void UndoShutter(Frame& frame, TrackEstimate& estimate, const MapSnapshot& map) const;
  // What that frame says of the readout.
  std::vector<ReadoutMatch> ReadoutMatches(const PlacedFrame& placed, const MapSnapshot& map) const;
  // First guess of the pose: an even motion and the last frame's landmarks, or the reference
  // keyframe.
  PlacedFrame Predict(std::shared_ptr<const Frame> frame, const MapSnapshot& map);
  // Pose from the local map, starting at the guess.
  TrackEstimate Estimate(PlacedFrame guess, const MapSnapshot& map);
  // Pose with no last frame to lean on (ORB-SLAM §V-C): descriptors against each of the keyframes
  // that may show the place, RANSAC, then the landmarks around. Tracked only when certain, and
  // where the camera `may_be` (empty: anywhere).
  TrackEstimate Relocalise(const std::shared_ptr<const Frame>& frame, const MapSnapshot& map,
                           std::span<const KeyFrameId> candidates,
                           const std::function<bool(const TrackEstimate&)>& may_be = {});

  // The same for a frame of earlier, near a keyframe in time. What is known of the last frame
  // stays.
  TrackEstimate PlaceAgain(const std::shared_ptr<const Frame>& frame, const MapSnapshot& map,
                           KeyFrameId near);

  // Pose of a frame that follows some without one, near where PredictedPose() has it. Tracked only
  // when certain, as Relocalise().
  TrackEstimate GoOn(const std::shared_ptr<const Frame>& frame, const MapSnapshot& map);

  // Tells what the last frame was: an estimate (perhaps with the landmarks a new keyframe added),
  // or a loss.
  // `map`: the one its pose is in.
  void Remember(const PlacedFrame& placed, KeyFrameId reference, const MapSnapshot& map);
  void Forget();  // where the camera was says nothing of where it is: no motion is known
  // A frame has no pose; the last one that had is remembered for a while.
  void Lose() { passing_.Clear(); }
  // Of a frame that has no pose (yet): where the last motion leads if it goes on evenly. None when
  // no motion is known or it is too long ago (settings.predict_seconds).
  std::optional<Se3> PredictedPose(double time, const MapSnapshot& map) const;  // T_camera_world
  // From now on the last frame hangs on no keyframe that is culled in `map`.
  void Reanchor(const MapSnapshot& map);

  KeyFrameId reference() const {
    return last_anchor_.keyframe;
  }  // of the last frame that was tracked
  const Camera& camera() const { return camera_; }
  void KeyFrameInserted(int frame_number) {
    last_keyframe_number_ = frame_number;
    most_inliers_ = 0;
  }

 private:
  struct InverseDepthsSeen {
    std::vector<float> of_keypoints;  // 1 / map units; 0: not known
    double common = 0;                // their median
  };
  static InverseDepthsSeen InverseDepths(const PlacedFrame& placed, const MapSnapshot& map);
  PlacedFrame PredictByMotion(std::shared_ptr<const Frame> frame, const MapSnapshot& map);
  // No frame was placed shortly before: how the camera moved says little of where it is.
  bool IsLate(const Frame& frame) const {
    return !last_.frame || frame.time - last_.frame->time > settings_.unproven_seconds;
  }
  // By descriptors alone, wherever in the picture; what of the two more of the map agrees with.
  PlacedFrame BetterByLooks(PlacedFrame guess, const MapSnapshot& map);
  void FindAround(PlacedFrame& placed, const MapSnapshot& map, int keyframes);
  Se3 MotionUntil(double time, const MapSnapshot& map) const;  // T_now_last, in lengths of today
  double Agreement(const PlacedFrame& placed, const MapSnapshot& map) const;
  void MatchLastFrame(PlacedFrame& guess, const MapSnapshot& map, float radius) const;
  void MatchKeyFrame(PlacedFrame& guess, const MapSnapshot& map, KeyFrameId id) const;
  // Returns the share of the matches that agree with the pose found; the others are dropped.
  double Optimise(PlacedFrame& placed, const MapSnapshot& map) const;
  bool IsCertain(const TrackEstimate& estimate) const;
  double Spread(const PlacedFrame& placed) const;
  bool WantsKeyFrame(const PlacedFrame& placed, double agreement) const;
  int Scaled(int count) const { return static_cast<int>(count * settings_.match_scale + 0.5); }

  Camera camera_;
  TrackerSettings settings_;
  bool has_depth_;
  Extractor extractor_, right_extractor_;
  LocalMapGatherer gatherer_;
  PassingPoints passing_;

  PlacedFrame last_;
  Anchor last_anchor_;  // where the last frame is, by its reference keyframe
  Motion motion_;       // up to the last frame, in the scale of the anchor
  int unproven_ = 0;    // frames left in which motion is not yet believed (settings)
  int last_keyframe_number_ = 0;
  int most_inliers_ = 0;  // of a frame since the last keyframe: what it could show at best
};

}  // namespace alidade
