// Visual SLAM in one class: images in, poses and a map out.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/base/byte_store.h"
#include "alidade/base/error.h"
#include "alidade/detect/detector.h"
#include "alidade/map/map_file.h"
#include "alidade/map/map_store.h"
#include "alidade/semidense/report.h"
#include "alidade/system/health.h"
#include "alidade/system/settings.h"
#include "alidade/system/types.h"

namespace ALIDADE_API alidade {

// Visual SLAM. Call Finish() after the last frame: without it the last adjustment and the poses of
// deferred localization are missing.
//
// Threads. Load, Track, Reset, Forget, SetMapping and Finish are driving calls. They may come from
// any thread; each waits until the one before it has returned. All other calls are queries: any
// thread may make them at any time, also during a driving call. A query delays Track() by no more
// than the copying of a few pointers (Times(): a megabyte), and does not wait until a frame, a
// keyframe or a commit is finished. It returns a value that belongs to the caller and never
// changes. Two queries may refer to different frames; values of one frame come from one call.
//
// Failures. Track() throws Error (input) if its input is invalid; the frame is then ignored. Any
// other exception (std::bad_alloc, cv::Exception, …) costs that frame its pose: it counts in
// frames(), unless memory is too low even for that, and the next frame is tracked as usual. An
// exception in another part (mapping, loop closing, full adjustment, semi-dense mapping, dynamics
// or detector, in both schedules) stops that part and drops its queue. It is not rethrown:
// TrackResult::warning of all later frames and Health() report it. Tracking continues in the
// existing map, which is always consistent, because an unfinished change is not committed. Without
// mapping the map does not grow.
class Slam {
 public:
  // Throws Error if the camera or the settings are invalid. RGB-D needs camera.depth_factor, stereo
  // camera.baseline, settings.dynamics.mode full a detector.
  Slam(const Camera& camera, const SlamSettings& settings,
       std::shared_ptr<Detector> detector = nullptr);
  ~Slam();  // no other call may be running; work in progress is ended early
  Slam(const Slam&) = delete;
  Slam& operator=(const Slam&) = delete;

  // Driving calls.

  // Continues in a saved map: DecodeMap() of what SaveMap() returned. Before the first frame.
  // Throws Error (input) if the map was made with another camera or sensor. With settings.localize
  // any camera and sensor will do, but depth in a map of one camera; images should have the map's
  // resolution in pixels per radian (settings.image_width, WidthAtResolutionOf()).
  void Load(const SavedMap& saved);
  // Leaves parts of the image out, in all frames: a hood, a gripper, a caption. `mask`: CV_8U of
  // any size, stretched over the image; nonzero = left out, at most 90 %. Before the first frame;
  // the last call counts. Parts that move with the camera are found without it
  // (settings.fixed_parts), too.
  void LeaveOut(const cv::Mat& mask);
  // FrameInput::imu are readings of this sensor. Before the first frame; without it, readings are
  // those of a sensor whose place and noise are unknown (ImuModel's defaults).
  // Throws Error (usage) if a value of the model cannot be.
  void SetImu(const ImuModel& imu);
  // Frames older than the newest few thousand are moved from memory to `store` from now on.
  // Trajectory() and Finish() read them again, and throw Error (input) if they cannot.
  void KeepFramesIn(std::shared_ptr<ByteStore> store);
  // Processes one frame; frames come in order of time. Throws Error (input) if an image has the
  // wrong size or type, or if the time does not increase. A jump of the time is treated as a cut
  // and reported in TrackResult::cut: the frame need not continue the last one. Forward, a jump is
  // a gap as defined by settings.time; backward, it takes settings.time.agree_frames frames with
  // increasing times.
  TrackResult Track(const FrameInput& input);
  // The next frame starts a new recording and may have any time. The maps are kept and extended.
  void Reset();
  // Removes all maps and the poses in them; the next frame starts anew, as after Reset(). A map
  // that was loaded is removed, too. Waits for the loop closer's step in progress.
  void Forget();
  // While off, poses are found in the maps as they are: no keyframe is added and no map started.
  // Keyframes that are there already are still adjusted, and their loops closed. On at first,
  // except with settings.localize.
  void SetMapping(bool on);
  // Waits until the workers have finished (a part that has failed does no more work), at most
  // `limit` seconds plus the time to end the current step. The map is consistent then. The next
  // Finish() does the remaining work, except for mapping the keyframes that were waiting: they stay
  // as inserted. Returns Trajectory(), or throws std::bad_alloc if there is no memory for it. More
  // frames may follow.
  std::vector<FramePose> Finish(double limit = std::numeric_limits<double>::infinity());
  // As if the limit of the running Finish(), or else of the next one, had passed. Any thread, also
  // during a driving call.
  void CutFinishShort();

  // Queries.

  SlamHealth Health() const;     // which parts run, and why a part stopped
  MapSnapshot Snapshot() const;  // cheap, consistent, safe to keep
  // Frames that Track() has counted: all but those refused with an Error. Includes the frame in
  // progress, which is in Trajectory() once it is finished.
  int frames() const;
  // All frames so far with FramePose::index at least `since`, except those older than
  // settings.trajectory.keep_seconds.
  std::vector<FramePose> Trajectory(int since = 0) const;
  // Of the last finished frame: its features, and the mask of moving objects (CV_8U, 255 = moving,
  // the camera's size; empty without dynamics, and with auto until something moves).
  std::vector<FeatureUse> Features() const;
  cv::Mat MoverMask() const;
  // The detector's newest result at that frame; nullopt before the first one, and without a
  // detector.
  std::optional<ShownDetections> Detections() const;
  // The map and everything that is saved with it; cheap, a value to read, keep or encode
  // (EncodeMap()).
  SavedMap Saved() const;
  std::string SaveMap() const;  // the map as bytes, the content of map.alidade
  StageTimes Times() const;
  LatestTimes Latest() const;
  // The camera in use: scaled to the processed images, with the readout time estimated so far.
  Camera camera() const;
  // With settings.refine: the camera estimated from the map, for the processed images; nullopt: no
  // sufficiently certain estimate so far. camera() follows it in steps.
  std::optional<CameraEstimate> camera_found() const;
  int camera_changes() const;  // how often camera() was changed to camera_found()
  // Standard deviation of the estimated readout time, seconds; 0: it was given, or not estimated.
  double readout_sigma() const;
  SlamCounts Counts() const;
  InertialReport Inertial() const;    // of the last finished frame
  SemiDenseReport SemiDense() const;  // of the keyframes processed so far
  // Frame::number of the first frame given to Track(); keyframes of a loaded map have smaller ones.
  int first_number() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace alidade
