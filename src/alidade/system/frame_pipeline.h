// One frame through the system, from image to pose, map and trajectory: FramePipeline::Process()
// names the steps in order. Private to system/; used by the driving thread, except where noted.
#pragma once

#include <atomic>
#include <memory>
#include <span>
#include <vector>

#include "alidade/system/camera/camera_update.h"
#include "alidade/system/frame_log.h"
#include "alidade/system/frame_placer.h"
#include "alidade/system/inertial/inertial_watch.h"
#include "alidade/system/inertial/orientation_watch.h"
#include "alidade/system/left_out.h"
#include "alidade/system/mover_watch.h"
#include "alidade/system/present_frame.h"
#include "alidade/system/published.h"
#include "alidade/system/revisit/early_frames.h"
#include "alidade/system/revisit/kept_frames.h"
#include "alidade/system/revisit/map_replay.h"
#include "alidade/system/revisit/relocalizer.h"
#include "alidade/system/session.h"
#include "alidade/system/start/map_start.h"
#include "alidade/system/start/young_map.h"
#include "alidade/system/workers/workers.h"
#include "alidade/tracking/tracker.h"

namespace alidade {

class FramePipeline {
 public:
  // `settings` outlives the pipeline. `camera`: as used, scaled to the images that are processed.
  FramePipeline(const Camera& camera, const SlamSettings& settings,
                const std::shared_ptr<Detector>& detector);

  // Counts a frame: the next call is Process() or Abandon() of it. `time`: seconds, as given.
  void BeginFrame(double time) { log_.Begin(time); }
  void KeepFramesIn(std::shared_ptr<ByteStore> store) { log_.KeepIn(std::move(store)); }
  // `prepared`: see Prepare(); its time is on the steady clock. `time`: as given.
  TrackResult Process(const FrameInput& prepared, double time);
  // The frame ended in an exception: it has no pose, and everything that may be inconsistent is
  // erased.
  void Abandon() noexcept;
  // The frame becomes readable in the trajectory.
  void EndFrame() noexcept;

  // Before the first frame. Throws Error (input) when the map is of another camera or sensor.
  void Load(const SavedMap& saved);
  // See Slam::LeaveOut().
  void LeaveOut(const cv::Mat& mask) { left_out_.Name(mask); }
  // See Slam::SetImu().
  void SetImu(const ImuModel& imu);
  // The next frame need not continue the last one.
  // `steady`: the time of that frame on the steady clock, seconds.
  void Cut(double steady) {
    session_.Apply(SessionEvent::kCut, steady);
    left_out_.Cut();
    inertial_.Cut();
    orientation_.Restart();
  }
  void BeginRecording();
  void Forget();  // see Slam::Forget()
  void SetMapping(bool on) { workers_.SetMapping(on); }
  // Waits for the workers, `limit` seconds at most, and uses what they found.
  void Finish(double limit);

  // Any thread may use these.
  const Workers& workers() const { return workers_; }
  Workers& workers() { return workers_; }
  const MoverWatch& movers() const { return movers_; }
  const LeftOut& left_out() const { return left_out_; }
  const FrameLog& trajectory() const { return log_; }
  const Published<Camera>& camera() const { return camera_shown_; }
  const Published<std::shared_ptr<const LastFrame>>& last_frame() const { return last_frame_; }
  const Published<InertialReport>& inertial() const { return inertial_shown_; }
  const PipelineCounts& counts() const { return counts_; }
  const SampleLog& extract_milliseconds() const { return extract_ms_; }
  const SampleLog& track_milliseconds() const { return track_ms_; }
  int first_number() const { return first_number_; }

 private:
  void CheckMapFits(const SavedMap& saved) const;
  void UseNews(PresentFrame& now);
  void TakeNews();
  void FinishWork(bool limited);
  void UseCamera();
  void UseInertial(std::span<const ImuSample> readings);
  void Reckon(double time, const MapSnapshot& map);
  void KeepWorld();
  void KeepMotions(const MapSnapshot& map);
  void ForgetUnit(MapId map);
  void Observe(double time, const PresentFrame& now);
  std::optional<CameraOrientation> Orient(double time, const PresentFrame& now,
                                          const TrackResult& result);
  void LeaveOutFixedParts(int number);
  void DropUnknownScale(PresentFrame& now);
  bool MayAlign(int number) const;
  bool AlignFrame(const FrameInput& prepared, double time, PresentFrame& now);
  void WatchReadout(const TrackEstimate& estimate, const MapSnapshot& map);
  void ExtractFeatures(const FrameInput& prepared, double time, PresentFrame& now);
  TrackResult Localize(PresentFrame& now);
  TrackEstimate FollowMotion(PresentFrame& now, const MapSnapshot& map);
  TrackEstimate FindPlace(PresentFrame& now, const MapSnapshot& map);
  TrackFailure JudgeTracked(const TrackEstimate& estimate, const PresentFrame& now,
                            const MapSnapshot& map);
  bool FollowsMovingObject(bool young);
  TrackResult Place(TrackEstimate estimate, PresentFrame& now, const MapSnapshot& map);
  TrackResult WithoutPose(TrackFailure failure, double time, const MapSnapshot& map);
  void KeepForLater(PresentFrame& now, const TrackResult& result);
  void Publish(const PresentFrame& now);
  void LocalizeEarlierFrames(int count, int number);
  void Reanchor();
  bool CollectsForRebuild() const;
  bool KeepsForFixedParts() const;
  bool TrustsFocalLength() const;
  int NumberOf(int index) const { return first_number_ + index; }  // Frame::number

  const SlamSettings& settings_;
  Camera camera_;
  Published<Camera> camera_shown_;  // camera_, for other threads
  bool dense_;                      // semi-dense mapping is on
  InertialWatch inertial_;          // outlives the workers, in which its fits run
  OrientationWatch orientation_;
  bool has_motions_ = false;          // keyframes have KeyFrame::motion
  double motions_hold_until_ = 1e18;  // InertialWatch::MotionsHoldUntil()
  Workers workers_;
  Tracker tracker_;
  MoverWatch movers_;
  LeftOut left_out_;
  YoungMap young_;     // one camera only
  EarlyFrames early_;  // one camera only
  KeptFrames kept_;
  FrameLog log_;
  Session session_;
  FramePlacer placer_;
  Relocalizer relocalizer_;
  MapStart start_;
  MapReplay replay_;
  CameraUpdate camera_update_;
  WorkerNews news_;             // not used yet
  bool more_left_out_ = false;  // a part fixed to the camera was found; not used yet
  double steady_ = 0;           // time of the present frame on the steady clock, seconds
  std::atomic<int> first_number_{
      0};  // Frame::number of the first frame: larger than those of a loaded map
  SampleLog extract_ms_, track_ms_;
  Published<InertialReport> inertial_shown_;
  PipelineCounts counts_;
  Published<std::shared_ptr<const LastFrame>> last_frame_;
};

}  // namespace alidade
