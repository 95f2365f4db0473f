// What Slam is made of: what the system keeps between frames, and what it does with one. Private to
// system/; its files have one matter each:
//   slam.cc            one frame, from image to pose and keyframe
//   slam_start.cc      a map is begun, loaded or given up
//   slam_lost.cc       a frame without a pose: gone on, found back, another map
//   slam_lens.cc       the camera that was given turns out to be another
//   slam_time.cc       time that jumps, new recordings, cuts
//   slam_failure.cc    a frame that ended in the middle, and what has stopped
//   slam_questions.cc  what any thread may ask
#pragma once

#include <atomic>
#include <deque>
#include <memory>
#include <mutex>
#include <vector>

#include "alidade/map/anchor.h"
#include "alidade/system/camera_clock.h"
#include "alidade/system/early_frames.h"
#include "alidade/system/frame_log.h"
#include "alidade/system/mover_watch.h"
#include "alidade/system/slam.h"
#include "alidade/system/workers.h"
#include "alidade/system/young_map.h"
#include "alidade/tracking/tracker.h"

namespace alidade {

class Slam::Impl {
 public:
  Impl(const Camera& given, const SlamSettings& settings,
       const std::shared_ptr<Detector>& detector);
  TrackResult Track(const FrameInput& input);
  void Load(const SavedMap& saved);
  void Reset();
  void Finish(double limit);
  SlamHealth Health() const;

  // The last frame that was done, for those who ask: never changed once it is shown.
  struct Shown {
    std::shared_ptr<const Frame> frame;
    std::vector<LandmarkId> matches;
    cv::Mat belief_of_cells;                            // of standing still; empty without dynamics
    KeyFrameId keyframe;                                // it became; none: it did not
    std::shared_ptr<const FrameDetections> detections;  // the newest; null: none so far
    double detections_age = 0;                          // seconds
  };
  std::shared_ptr<const Shown> shown() const {
    const std::lock_guard<std::mutex> lock(shown_mutex_);
    return shown_;
  }

  Camera CameraNow() const {
    const std::lock_guard<std::mutex> lock(camera_mutex_);
    Camera camera = camera_;
    camera.readout = workers_.readout();
    return camera;
  }

  Camera given_;
  SlamSettings settings_;
  Camera camera_;  // changed by the driving call alone, with camera_mutex_ held
  mutable std::mutex camera_mutex_;
  std::atomic<int> camera_changes_{0};
  bool dense_;  // semi-dense mapping is asked for
  Workers workers_;
  Tracker tracker_;
  MoverWatch movers_;
  PlacedFrame last_;          // the present frame, as it was tracked
  KeyFrameId last_keyframe_;  // it became
  YoungMap young_;            // of one camera
  EarlyFrames early_;         // likewise
  // The frame before this one, where it hung on a keyframe that went with the start of this one …
  struct OrphanFrame {
    int index = -2;  // in the log
    Anchor anchor;   // … and where it is, should this one be found in the same map
    MapId map;
  };
  OrphanFrame orphan_;
  TrackState state_ = TrackState::kInitialising;
  FrameLog log_;
  CameraClock clock_;
  SampleLog frame_ms_, extract_ms_, track_ms_;
  std::atomic<int> relocalisations_{0}, cuts_{0}, predicted_{0};
  std::atomic<int> frames_{0};        // counted so far
  std::atomic<int> first_number_{0};  // of the next recording's frames, after a loaded map's

 private:
  // slam.cc: a frame.
  TrackResult TrackCounted(const FrameInput& prepared, double time);
  TrackResult Continue(const std::shared_ptr<Frame>& frame);
  bool KnowsLens() const;
  bool FollowsMover(bool young);
  TrackResult Accept(TrackEstimate estimate, const MapSnapshot& map);
  void Place(const PlacedFrame& placed, KeyFrameId reference, const MapSnapshot& map);
  void AddKeyFrame(PlacedFrame& placed, const Anchor& anchor);
  void Reanchor();
  void PlaceEarly(int count, int number);

  // slam_lost.cc: frames without a pose.
  TrackResult FindBack(const std::shared_ptr<Frame>& frame);
  bool CanBeThere(const TrackEstimate& found, const MapSnapshot& map) const;
  std::vector<KeyFrameId> PlacesLike(const Frame& frame, const MapSnapshot& map);
  TrackResult FoundBack(TrackEstimate estimate, const MapSnapshot& map);
  TrackResult WithoutPose(const char* reason, double time, const MapSnapshot& map);
  void Lose();
  void LeaveMap();
  bool LeavesUnknownScale();
  void KeepFramesBetween(MapId gone);
  void ForgetWhere();

  // slam_start.cc: the begin and the end of a map.
  TrackResult Start(const std::shared_ptr<Frame>& frame);
  bool StartWithDepth(const std::shared_ptr<Frame>& frame, TrackResult& result);
  bool StartWithMotion(const std::shared_ptr<Frame>& frame, TrackResult& result);
  TrackResult GiveUpStart(const char* reason);

  // slam_lens.cc: another camera than was given.
  bool RefineCamera();
  void ChangeCamera(const Camera& camera);
  void BeginAnew(const Camera& camera);
  struct KeptFrame {
    std::shared_ptr<const Frame> frame;
    int index = 0;  // in the log
  };
  void TrackAgain(const KeptFrame& kept);
  bool KeepsFrames() const;
  void KeepFrame(const Frame& frame);
  int Index() const { return again_ >= 0 ? again_ : log_.size() - 1; }

  // slam_time.cc: time that jumps.
  const char* Tick(double time);
  void Cut();

  // slam_failure.cc: a frame that ended in the middle.
  void Recover(TrackState before) noexcept;
  void EndFrame() noexcept;

  // slam_questions.cc: what is published.
  void Show();

  // Frames since the first that the map was begun with, while its camera is looked for: oldest
  // first. Their indices in the log follow each other.
  std::deque<KeptFrame> kept_;
  bool keeps_ = true;  // false: the map has more of them than are kept
  Camera begun_with_;  // the camera the map was begun with
  int again_ = -1;     // index of a kept frame that is tracked again; -1: none is
  int begun_anew_ = 0;

  double lost_since_ = 0;  // when the first frame without a pose came, by the steady clock, seconds
  int lost_sighted_ = 0;   // frames since that showed something
  bool jump_told_ = false;  // of the time, to the user
  bool restarted_ = false;  // Reset() was called since the last frame

  std::mutex driving_;  // held by the driving call that is under way
  mutable std::mutex shown_mutex_;
  std::shared_ptr<const Shown> shown_;
};

}  // namespace alidade
