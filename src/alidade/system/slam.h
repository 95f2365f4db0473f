// Visual SLAM behind one class: images in, poses and a map out.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/base/error.h"
#include "alidade/detect/detector.h"
#include "alidade/map/map_file.h"
#include "alidade/map/map_store.h"
#include "alidade/semidense/report.h"
#include "alidade/system/health.h"
#include "alidade/system/settings.h"
#include "alidade/system/types.h"

namespace ALIDADE_API alidade {

// Threads. The driving calls, Load, Track, Reset and Finish, take turns: one waits for the one
// before it, from whatever thread it comes. All others are questions. Any thread may ask them at
// any time, beside a driving call, too; none of them makes Track() wait longer than it takes to
// copy a few pointers (Times(): a megabyte), and none waits for a frame, a keyframe or a commit to
// be done. Every answer is a value that belongs to the caller and never changes. Two answers may be
// of different moments: what is of one frame comes out of one call.
//
// Failure. Track() throws Error (input) on what it is given; nothing has changed then. Anything
// else it throws (std::bad_alloc, cv::Exception, …) has cost that one frame: it counts, unless
// there was no memory even for that (see frames()), and the next one is tracked as ever. What a
// part of the system beside the tracker throws (mapping, loop closing, full adjustment, semi-dense
// mapping, dynamics, the detector; threaded or not) ends that part, drops what waits for it, and is
// told by TrackResult::warning of the next Track() and all after it, and by Health(); it is thrown
// nowhere. The tracker goes on in the map that stands, which is always whole: a change that was not
// finished has not happened. Without mapping it grows no more.
class Slam {
 public:
  // Throws Error on a camera or settings that cannot be. RGB-D needs camera.depth_factor, stereo
  // camera.baseline, settings.dynamics.mode full a detector.
  Slam(const Camera& camera, const SlamSettings& settings,
       std::shared_ptr<Detector> detector = nullptr);
  ~Slam();  // when no other call is under way; what is in work is cut short
  Slam(const Slam&) = delete;
  Slam& operator=(const Slam&) = delete;

  // Driving calls.

  // Goes on in a saved map (DecodeMap() of what SaveMap() gave). Before the first frame. Throws
  // Error (input) when it was made with another camera or sensor.
  void Load(const SavedMap& saved);
  // One frame, in order of time. Throws Error (input) on an image of the wrong size or type, or a
  // time that does not grow. A time that has jumped is told (TrackResult::cut) and taken as a cut:
  // known places are tried before the last one is believed. Ahead: a gap (settings.time). Back:
  // when as many frames as settings.time.agree_frames agree.
  TrackResult Track(const FrameInput& input);
  // The next frame begins a new recording, its time may be any; the maps are kept and gone on with.
  void Reset();
  // Waits until the workers have nothing left to do (those that failed have not), `limit` seconds
  // at most, and what it takes to end the step in work. The map is sound then; the next Finish()
  // does what was left, but for keyframes that waited to be mapped: they stay as they were entered.
  void Finish(double limit = std::numeric_limits<double>::infinity());
  // Any thread's, beside a driving call: as if the limit of Finish() were reached.
  void CutFinishShort();

  // Questions.

  SlamHealth Health() const;     // which parts run, and why one does not any more
  MapSnapshot Snapshot() const;  // cheap, consistent, safe to keep
  // How many frames Track() has counted: all but those it refused with an Error. One that is in
  // work counts; Trajectory() has it once it is done.
  int frames() const;
  // Every frame so far that was not let go, from the `since`th on: FramePose::index.
  std::vector<FramePose> Trajectory(int since = 0) const;
  // Of the last frame that was done: its features, and what was left out as moving (CV_8U, 255, of
  // the camera's size; empty without dynamics, and while `auto` has seen nothing).
  std::vector<FeatureUse> Features() const;
  cv::Mat MoverMask() const;
  // The newest answer that had come by then; nothing before the first one, and without a detector.
  std::optional<ShownDetections> Detections() const;
  // The map with all that is saved of it: cheap, a value to read, keep or encode (EncodeMap()).
  SavedMap Saved() const;
  std::string SaveMap() const;  // the map as bytes (map.alidade), to be written where it pleases
  StageTimes Times() const;
  LatestTimes Latest() const;
  // As used: scaled by the profile, with what was found of its rolling shutter by now.
  Camera camera() const;
  // With settings.refine: what the map says of a camera nobody calibrated, of the size it is used
  // in; none: nothing it can vouch for so far. camera() follows it, in steps.
  std::optional<CameraEstimate> camera_found() const;
  int camera_changes() const;  // how often camera() changed in the middle of a map
  // Standard deviation of that, seconds; 0: the camera told it, or none was found.
  double readout_sigma() const;
  SlamCounts Counts() const;
  SemiDenseReport SemiDense() const;  // of the keyframes that are done
  // Frame::number of the first call of Track(): keyframes of a loaded map have smaller ones.
  int first_number() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace alidade
