// Moving objects, frame by frame: runs the detector and the dynamic filter, and applies their
// results to frames and landmarks. With dynamics.mode off everything counts as static. With auto it
// does, too, while the filter examines some of the frames; once much of the image moves, or the
// poses follow a moving object, moving objects are left out
// (docs/development/decisions/0019-dynamics-auto.md). Used by the driving thread, except where
// noted.
#pragma once

#include <atomic>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/detect/detector.h"
#include "alidade/dynamics/dynamic_filter.h"
#include "alidade/map/map_store.h"
#include "alidade/system/health.h"
#include "alidade/system/settings.h"
#include "alidade/system/types.h"
#include "alidade/system/workers/detection_feed.h"
#include "alidade/tracking/tracker.h"

namespace alidade {

// What a frame reports to the mapper about the landmarks that should be visible in it.
struct LandmarkNews {
  // Whether each was found. Without those that moving objects may have hidden.
  std::vector<std::pair<LandmarkId, bool>> sightings;
  std::vector<std::pair<LandmarkId, float>> evidence;  // of being static, log-odds
};

// Calls for each frame: Begin(), Judge(), Place() if it has a pose, End().
class MoverWatch {
 public:
  // Throws Error (usage) when settings.dynamics.mode is full and there is no detector.
  MoverWatch(const Camera& camera, const SlamSettings& settings,
             const std::shared_ptr<Detector>& detector);

  bool on() const { return used_; }  // moving objects are left out
  // Starts a frame, before its features are extracted. `placed`: the last frame has a pose that
  // optical flow can be compared with. `young`: the frame belongs to a map of one camera that may
  // still be dropped.
  void Begin(const FrameInput& prepared, int number, bool placed, bool young);
  // The detector's newest result; null: none so far. Its age: time from its image to the present
  // one, seconds.
  const std::shared_ptr<const FrameDetections>& detections() const { return answer_; }
  double detections_age() const { return now_ - answer_time_; }
  cv::Mat Expected() const;  // as DynamicFilter::ExpectedMovers(); empty: none
  // Sets the static probabilities of the frame's keypoints, before its pose is estimated, and the
  // mask of its picture, if it has one. `guess`: the predicted or aligned pose; null: there is
  // none.
  void Judge(Frame& frame, const PoseGuess* guess);
  // Call once for each frame judged with a guess. True if the poses of the last frames follow a
  // moving object, while most of the image agrees on another motion. With auto, moving objects are
  // left out from the next frame on if so, or if much of the image moves; without RGB-D, this frame
  // already gives evidence on landmarks. `young`: the frame is in a young map; in older maps the
  // test runs only while auto has not left anything out.
  bool FollowsMover(bool young);
  void Forget();  // drops what was estimated from such poses
  // Returns no evidence if more than half (landmarks.most_on_movers) of the expected landmarks lie
  // on moving objects, since then the segmentation is probably wrong.
  LandmarkNews NewsOf(const TrackEstimate& estimate, const MapSnapshot& map) const;
  void Place(const WorldId& world) { world_ = world; }  // the world that the frame's pose is in
  // Before End(), for a frame without features of its own; see DynamicFilter.
  void SeedCorners(const cv::Mat& left_out);
  void End(const Frame& frame, const TrackResult& result);
  // All frames from now on are of this camera; what was estimated about the image is dropped.
  void SetCamera(const Camera& camera);
  // An exception ended a frame: drops everything. If the filter cannot be created again, dynamics
  // stop; see health().
  void Recover() noexcept;
  // A part of the image that seemed to move was fixed to the camera: everything begins again.
  void Restart() noexcept;

  // As DynamicFilter::BeliefOfCells(); valid after End(); empty when off.
  cv::Mat BeliefOfCells() const {
    return counts_ && filter_ ? filter_->BeliefOfCells() : cv::Mat();
  }
  // Any thread may call these. Times: one sample per frame that the filter, or the detector,
  // processed.
  const SampleLog& milliseconds() const { return milliseconds_; }
  const std::vector<std::string>& class_names() const { return class_names_; }  // of the detector
  const SampleLog& detector_milliseconds() const { return detections_.milliseconds(); }
  std::vector<StageHealth> health() const;
  bool any_stopped() const { return filter_failed_ || detections_.failure(); }

 private:
  bool Watches(bool young);    // with auto: whether the filter examines the frame
  bool MuchMoves(bool young);  // with auto: whether too much of the image moves to stay off
  // Keeps the newest result of the detector and the time of its image.
  void Remember(const std::optional<FrameDetections>& arrived, int number, double time);

  DetectionFeed detections_;
  std::optional<DynamicFilter> filter_;  // empty: everything counts as static
  std::atomic<bool> used_{false};        // moving objects are left out, from the next frame on
  bool looks_ = false;                   // the filter processes the present frame
  bool counts_ = false;                  // moving objects are left out of the present frame
  int watched_ = 0;                      // auto: consecutive examined frames
  int rest_ = 0;                         // auto: frames until examination resumes
  std::deque<double> moved_;             // DynamicFilter::MovedShare() of the last examined frames
  WorldId world_;                        // of the last pose
  // Frames whose pose follows a moving object, minus the others; at least 0.
  int doubtful_ = 0;
  // Numbers and times of frames whose detections may still arrive.
  std::deque<std::pair<int, double>> offered_;
  std::shared_ptr<const FrameDetections> answer_;
  double answer_time_ = 0, now_ = 0;  // times of its image and of the present one, seconds
  double present_ms_ = 0;             // spent on the present frame so far
  SampleLog milliseconds_;

  Camera camera_;
  Sensor sensor_;
  DynamicsSettings settings_;
  std::vector<std::string> class_names_;  // of the detector
  std::atomic<bool> filter_failed_{false};
  mutable std::mutex failure_mutex_;
  std::exception_ptr failure_;  // what ended the filter
};

}  // namespace alidade
