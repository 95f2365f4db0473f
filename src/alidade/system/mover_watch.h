// What moves, frame by frame: the detector and the dynamic filter, and what they say of frames and
// landmarks. Without dynamics everything is taken to stand still. With `auto`, too, while the
// filter looks at some of the frames: until much of the picture moves, or the poses follow
// something that does.
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
#include "alidade/system/detection_feed.h"
#include "alidade/system/health.h"
#include "alidade/system/types.h"
#include "alidade/tracking/tracker.h"

namespace alidade {

// What a frame tells the mapper of the landmarks that should have been seen.
struct LandmarkNews {
  std::vector<std::pair<LandmarkId, bool>> sightings;  // found or not, but for what movers hid
  std::vector<std::pair<LandmarkId, float>> evidence;  // log-odds of standing still
};

// For every frame Begin, Judge, Place when it has a pose, and End.
class MoverWatch {
 public:
  // Throws Error (usage) when settings.dynamics.mode is full and there is no detector.
  MoverWatch(const Camera& camera, const SlamSettings& settings,
             const std::shared_ptr<Detector>& detector);

  bool on() const { return used_; }  // what moves is left out
  // Before there are features. `placed`: the last frame has a pose that flow can be held against.
  // `young`: in a map of one camera that may yet be begun again.
  void Begin(const FrameInput& prepared, int number, bool placed, bool young);
  // The detector's newest answer, and how old the picture was that it is of when the present frame
  // came, seconds; null: none so far.
  const std::shared_ptr<const FrameDetections>& detections() const { return answer_; }
  double detections_age() const { return now_ - answer_time_; }
  cv::Mat Expected() const;  // as DynamicFilter::ExpectedMovers; empty: none
  // What the features are worth, before the pose is made of them; the frame's picture, if it has
  // one, gets the mask. `guess`: null when there is none.
  void Judge(Frame& frame, const PoseGuess* guess);
  // Once for each frame judged with a guess: whether the poses of the last ones follow something
  // that moves, while the room agrees on another motion. With `auto` what moves is left out from
  // the next frame on (and this one tells of landmarks on it), as when much of the picture moves.
  // `young`: the map is; older ones are asked about with `auto` alone.
  bool FollowsMover(bool young);
  void Forget();  // what was believed by such poses
  // No evidence when half of what was expected lies on movers: it is those that are not believed.
  LandmarkNews NewsOf(const TrackEstimate& estimate, const MapSnapshot& map) const;
  void Place(const WorldId& world) { world_ = world; }  // whose world the frame's pose is in
  void End(const Frame& frame, const TrackResult& result);
  // Of all frames from now on: what was believed of the picture is forgotten.
  void SetCamera(const Camera& camera);
  // A frame ended in the middle, by what it threw: forgets all there was. What cannot be begun anew
  // is off from now on, see health().
  void Recover() noexcept;

  // As DynamicFilter::BeliefOfCells, after End; empty when off.
  cv::Mat BeliefOfCells() const {
    return counts_ && filter_ ? filter_->BeliefOfCells() : cv::Mat();
  }
  // Any thread may ask. One for each frame the filter had; one for each the detector was given.
  const SampleLog& milliseconds() const { return milliseconds_; }
  const std::vector<std::string>& class_names() const { return class_names_; }  // the detector's
  const SampleLog& detector_milliseconds() const { return detections_.milliseconds(); }
  std::vector<StageHealth> health() const;
  bool any_stopped() const { return filter_failed_ || detections_.failure(); }

 private:
  bool Watches(bool young);    // with `auto`, a frame: whether the filter looks at it
  bool MuchMoves(bool young);  // likewise: with this frame too much to go on with
  void Remember(const std::optional<FrameDetections>& arrived, int number, double time);

  DetectionFeed detections_;
  std::optional<DynamicFilter> filter_;  // none: everything is taken to stand still
  std::atomic<bool> used_{false};        // what the filter says counts, from the next frame on
  bool looks_ = false;                   // the filter has the present frame, until its End()
  bool counts_ = false;                  // what it says of that frame counts
  int watched_ = 0;                      // frames of the present look, with `auto` …
  int rest_ = 0;                         // … and those until the next
  std::deque<double> moved_;             // of its last frames, DynamicFilter::MovedShare()
  WorldId world_;                        // of the last pose
  int doubtful_ = 0;                     // frames whose pose follows a mover, less the others
  std::deque<std::pair<int, double>> offered_;  // frames, and their times: not answered yet
  std::shared_ptr<const FrameDetections> answer_;
  double answer_time_ = 0, now_ = 0;  // of the frames, seconds
  double present_ms_ = 0;             // of the present frame, so far
  SampleLog milliseconds_;

  Camera camera_;
  Sensor sensor_;
  DynamicsSettings settings_;
  std::vector<std::string> class_names_;  // the detector's
  std::atomic<bool> filter_failed_{false};
  mutable std::mutex failure_mutex_;
  std::exception_ptr failure_;  // of the filter
};

}  // namespace alidade
