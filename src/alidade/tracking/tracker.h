// Tracking: camera pose of the current frame relative to the map. Reads the map only. Mur-Artal,
// Montiel & Tardós 2015, §V; with depth as in Mur-Artal & Tardós 2017.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "alidade/map/anchor.h"
#include "alidade/map/map_store.h"
#include "alidade/optimize/pose_only.h"
#include "alidade/tracking/frame_alignment.h"
#include "alidade/tracking/local_map.h"
#include "alidade/tracking/local_search.h"
#include "alidade/tracking/motion.h"
#include "alidade/tracking/passing_points.h"
#include "alidade/tracking/placed_frame.h"
#include "alidade/tracking/readout.h"
#include "alidade/tracking/settings.h"

namespace alidade {

// A landmark expected in the frame.
struct SightingCount {
  LandmarkId landmark;
  bool found = false;  // it was matched
};

struct TrackEstimate {
  bool tracked = false;
  PlacedFrame placed;
  KeyFrameId reference;                  // keyframe that shares the most landmarks with the frame
  std::vector<SightingCount> sightings;  // landmarks expected to be visible
  double agreement = 0;                  // share of the matches that fit the pose
  double evidence = 0;  // log-likelihood ratio of a right to a wrong pose (PoseEvidence)
  bool wants_keyframe = false;
  // Of an aligned frame, one per keypoint: what was added to its position so that it agrees with
  // its landmark in the reference, pixels. Otherwise empty.
  std::vector<Eigen::Vector2f> moved;
};

// One thread at a time.
class Tracker {
 public:
  // `camera`: of the frames; depth_factor and baseline are 0 for monocular use.
  Tracker(const Camera& camera, TrackerSettings settings);

  // Extracts features. `right` and `depth` may be empty. `avoid`: see Extractor::Extract().
  std::shared_ptr<Frame> Extract(const cv::Mat& image, const cv::Mat& right, const cv::Mat& depth,
                                 double time, int number, const cv::Mat& avoid = {});
  // The frame of `image` by aligning the landmarks of the last extracted frame with it, instead of
  // extracting its features; its keypoints are those landmarks. `depth` may be empty. `left_out`:
  // CV_8U of any size, stretched over the image, nonzero where nothing is used; may be empty.
  // nullopt: features are needed, because a keyframe is due or too few landmarks are found; `align`
  // is off; or there is no such frame.
  std::optional<TrackEstimate> Align(const cv::Mat& image, const cv::Mat& depth, double time,
                                     int number, const cv::Mat& left_out, const MapSnapshot& map);
  // Changes the readout time (Camera::readout) from the next frame on.
  void SetReadout(const std::array<double, 2>& readout) { camera_.readout = readout; }
  // Rotation R_now_last of the frame at `time` since the last frame, as an inertial sensor tells
  // it; nullopt: it does not. It replaces that of the motion model.
  void SetTurn(double time, const std::optional<Eigen::Matrix3d>& R_now_last) {
    turn_time_ = time;
    turn_ = R_now_last;
  }
  // Pose T_camera_world of the frame at `time`, which does not follow a tracked one, by dead
  // reckoning; nullopt: it is not known. It replaces the motion model.
  void SetReckoned(double time, const std::optional<Se3>& T_camera_world) {
    reckoned_time_ = time;
    reckoned_ = T_camera_world;
  }
  // Changes the camera model for the following frames and the stored last frame.
  void SetCamera(const Camera& camera);
  // Rolling shutters: corrects the keypoints with the predicted motion.
  void UndoShutter(Frame& frame, const MapSnapshot& map) const;
  // Repeats the correction with the estimated motion, and optimizes the pose again. `frame` is the
  // estimate's frame.
  void UndoShutter(Frame& frame, TrackEstimate& estimate, const MapSnapshot& map) const;
  // Residuals of the frame for estimating the readout time.
  std::vector<ReadoutMatch> ReadoutMatches(const TrackEstimate& estimate,
                                           const MapSnapshot& map) const;
  // Initial pose: constant velocity and matches with the last frame's landmarks, or matches with
  // the reference keyframe.
  PlacedFrame Predict(std::shared_ptr<const Frame> frame, const MapSnapshot& map);
  // Pose from the local map, starting at the guess.
  TrackEstimate Estimate(PlacedFrame guess, const MapSnapshot& map);
  // Pose without a previous frame (Mur-Artal et al. 2015, §V-C): descriptor matches with each
  // candidate keyframe, RANSAC, then the surrounding landmarks. `tracked` only if the pose is right
  // with settings.evidence.min_probability and accepted by `may_be` (empty: always).
  TrackEstimate Relocalise(const std::shared_ptr<const Frame>& frame, const MapSnapshot& map,
                           std::span<const KeyFrameId> candidates,
                           const std::function<bool(const TrackEstimate&)>& may_be = {});

  // The same for an earlier frame, with a keyframe near it in time as candidate. The state of the
  // last frame is not changed.
  TrackEstimate PlaceAgain(const std::shared_ptr<const Frame>& frame, const MapSnapshot& map,
                           KeyFrameId near);

  // Pose of a frame after frames without a pose, near PredictedPose(). `tracked` only if it is
  // right with settings.evidence.min_probability.
  TrackEstimate GoOn(const std::shared_ptr<const Frame>& frame, const MapSnapshot& map);

  // Sets the last frame: its pose in `map` and its matches (perhaps with the landmarks of a new
  // keyframe).
  void Remember(const PlacedFrame& placed, KeyFrameId reference, const MapSnapshot& map);
  void Forget();  // resets last frame and motion, e.g. after a cut
  // The frame has no pose; the last frame and the motion are kept.
  void Lose() { passing_.Clear(); }
  // T_camera_world of a frame without a pose by dead reckoning, or extrapolated; nullopt if neither
  // is known: no motion, or a last frame older than settings.predict_seconds.
  std::optional<Se3> PredictedPose(double time, const MapSnapshot& map) const;
  // Moves the last frame's anchor to a live keyframe if its keyframe was culled in `map`.
  void Reanchor(const MapSnapshot& map);

  // Reference keyframe of the last tracked frame.
  KeyFrameId reference() const { return last_anchor_.keyframe; }
  // Time of the last tracked frame, seconds; NaN if there is none.
  double last_time() const {
    return last_.frame ? last_.frame->time : std::numeric_limits<double>::quiet_NaN();
  }
  // Pose of the camera `placed` in that of the last tracked frame, both by the landmarks of `map`,
  // in which `placed` was estimated: if the map changed since, the last frame is fitted to it
  // again, or moved along with its keyframe where too few of its landmarks are left. nullopt: no
  // frame precedes it.
  std::optional<Se3> T_last_camera(const PlacedFrame& placed, const MapSnapshot& map) const;
  bool IsLast(const Frame& frame) const { return last_.frame.get() == &frame; }
  const Camera& camera() const { return camera_; }
  void KeyFrameInserted(int frame_number) {
    last_keyframe_number_ = frame_number;
    most_inliers_ = 0;
  }

 private:
  void KeepReference(const PlacedFrame& placed, KeyFrameId keyframe, const MapSnapshot& map);
  struct ReferenceView {
    Se3 T_camera_world;
    std::vector<ReferencePoint> points;
    std::vector<const Landmark*> landmarks;  // of the points
    std::vector<Eigen::Vector2f> errors;     // their projections minus their keypoints, pixels
  };
  ReferenceView ViewReference(const MapSnapshot& map);
  void AddAligned(const ReferenceView& view, std::span<const AlignedPoint> aligned, Frame& frame,
                  std::vector<LandmarkId>& matches) const;
  static std::vector<Eigen::Vector2f> MoveByErrors(const ReferenceView& view,
                                                   std::span<const AlignedPoint> aligned,
                                                   Frame& frame);
  void CountAligned(const ReferenceView& view, std::span<const AlignedPoint> aligned,
                    TrackEstimate& estimate) const;
  bool SufficesAligned(const TrackEstimate& estimate);
  void UndoShutter(Frame& frame, const PlacedFrame& placed, const MapSnapshot& map) const;
  struct InverseDepthsSeen {
    std::vector<float> of_keypoints;  // 1 / map units; 0: unknown
    double common = 0;                // median
  };
  static InverseDepthsSeen InverseDepths(const PlacedFrame& placed, const MapSnapshot& map);
  PlacedFrame PredictByMotion(std::shared_ptr<const Frame> frame, const MapSnapshot& map);
  // True if no recent frame has a pose, so that the motion model is unreliable.
  bool IsLate(const Frame& frame) const {
    return !last_.frame || frame.time - last_.frame->time > settings_.max_motion_age;
  }
  // Matches the whole image by descriptors only, and returns this guess or the given one, whichever
  // agrees better with the map.
  PlacedFrame BetterByLooks(PlacedFrame guess, const MapSnapshot& map);
  void FindAround(PlacedFrame& placed, const MapSnapshot& map, int keyframes);
  Se3 MotionUntil(double time, const MapSnapshot& map) const;  // T_now_last, in current map units
  double Agreement(const PlacedFrame& placed, const MapSnapshot& map) const;
  void MatchLastFrame(PlacedFrame& guess, const MapSnapshot& map, float radius) const;
  void MatchKeyFrame(PlacedFrame& guess, const MapSnapshot& map, KeyFrameId id) const;
  // Returns the share of matches consistent with the optimized pose; the others are removed.
  double Optimise(PlacedFrame& placed, const MapSnapshot& map) const;
  // Relocalise() with another probability (log-odds) of the candidates.
  TrackEstimate FindIn(const std::shared_ptr<const Frame>& frame, const MapSnapshot& map,
                       std::span<const KeyFrameId> candidates, double prior,
                       const std::function<bool(const TrackEstimate&)>& may_be);
  struct MatchError {
    double chi2 = 0;             // of the pixel, with the nominal noise
    double chi2_disparity = -1;  // < 0: unknown
  };
  MatchError ErrorOf(const PlacedFrame& placed, size_t keypoint, const Landmark& landmark) const;
  // Sets the sightings of the placed frame, and the evidence in them.
  void CountExpected(const LocalMatches& found, const MapSnapshot& map,
                     TrackEstimate& estimate) const;
  // Pose and evidence from the local map, not judged yet.
  TrackEstimate Compare(PlacedFrame guess, const MapSnapshot& map);
  // Sets `tracked` and the pose's log-odds, which are `prior` and the evidence together.
  void Judge(TrackEstimate& estimate, double prior, const MapSnapshot& map);
  double Spread(const PlacedFrame& placed) const;
  bool WantsKeyFrame(const PlacedFrame& placed, double agreement) const;
  double LeastInliers() const;            // a frame with fewer becomes a keyframe
  static constexpr double kGate = 2.448;  // root of chi², 95 % with 2 degrees of freedom
  // With fewer landmarks with depth in view, a keyframe is due.
  static constexpr int kFewNear = 100;
  int Scaled(int count) const { return static_cast<int>(count * settings_.match_scale + 0.5); }

  Camera camera_;
  TrackerSettings settings_;
  bool has_depth_;
  Extractor extractor_, right_extractor_;
  LocalMapGatherer gatherer_;
  PassingPoints passing_;

  // The last frame with a pose whose features were extracted. Frames are aligned to it.
  struct {
    std::shared_ptr<const Frame> frame;
    std::vector<LandmarkId> matches;
    Anchor anchor;             // relative to its reference keyframe
    bool is_keyframe = false;  // then `anchor` is relative to itself
    int inliers = 0;
    int most_found = 0;  // largest number of inliers among the frames aligned to it
  } reference_;
  FrameAlignment alignment_;
  cv::Mat extracted_;  // image of the frame extracted last, until it has a pose
  int extracted_number_ = -1;

  PlacedFrame last_;
  Anchor last_anchor_;         // pose of the last frame relative to its reference keyframe
  Motion motion_;              // up to the last frame, in the anchor's scale
  uint64_t last_version_ = 0;  // of the map in which last_ was estimated
  double turn_time_ = 0;
  std::optional<Eigen::Matrix3d> turn_;  // R_now_last at turn_time_, by an inertial sensor
  double reckoned_time_ = 0;
  std::optional<Se3> reckoned_;  // T_camera_world at reckoned_time_
  // That the camera is where the motion since the last frame leads.
  struct {
    double log_odds = 0;
    double time = 0;
  } belief_;
  int unproven_ = 0;  // remaining frames in which the motion model is not trusted (settings)
  int last_keyframe_number_ = 0;
  int most_inliers_ = 0;  // largest number of inliers since the last keyframe
};

}  // namespace alidade
