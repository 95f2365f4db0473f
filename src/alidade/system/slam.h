// Visual SLAM behind one class: images in, poses and a map out.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/base/error.h"
#include "alidade/base/timing.h"
#include "alidade/detect/detector.h"
#include "alidade/map/map_file.h"
#include "alidade/map/map_store.h"
#include "alidade/semidense/report.h"
#include "alidade/system/health.h"
#include "alidade/system/settings.h"

namespace ALIDADE_API alidade {

enum class TrackState { kInitialising, kTracking, kLost };

struct FrameInput {
  double time = 0;  // seconds
  cv::Mat image;    // 8 bit grey (or BGR), the camera's size
  cv::Mat right;    // stereo: the rectified right image
  cv::Mat depth;  // RGB-D: registered depth, CV_16U in camera.depth_factor units or CV_32F metres;
                  // empty = none
  cv::Mat color = {};  // `image` in colour (BGR) when it is grey, for clouds; empty = none
};

// How far a pose can be relied on.
struct PoseQuality {
  // Covariance of the pose's error, in the camera's own frame: T_world_camera * Exp(xi) is true
  // with xi = (translation; rotation) ~ N(0, covariance); m², m rad, rad² (monocular: map units).
  // From the normal equations of the pose, scaled by the residuals, so that noise of images and
  // landmarks is in it. It is the error against the map as it stands around the camera; what the
  // map itself is off by, in its world (drift, until a loop closes), is not in it: with one camera,
  // in the first second or two of a map, motions are off by some four times what this says. Zero:
  // not known, or the first frame of a map, which is where it is by definition.
  Matrix6d covariance = Matrix6d::Zero();
  int expected = 0;        // landmarks that should be in view
  int inliers = 0;         // of these, found where the pose says
  double found_share = 0;  // inliers / expected, 0…1. A third is usual: some are hidden
};

struct TrackResult {
  TrackState state = TrackState::kInitialising;
  Se3 T_world_camera;  // only when tracking or predicted
  // Lost, for so short that the camera is taken to go on as it moved (tracker.predict_seconds):
  // T_world_camera is where that leads. A guess: it is in no trajectory.
  bool predicted = false;
  int matches = 0;          // landmarks the pose agrees with
  bool keyframe = false;    // this frame became one
  const char* reason = "";  // why there is no pose
  const char* cut = "";     // why the frame does not go on where the one before was
  PoseQuality quality;      // of the pose; only when tracking
  std::string warning;      // what has stopped: SlamHealth::Stopped(), with every frame since
};

// One frame of the finished trajectory.
struct FramePose {
  int index = 0;      // call of Track() it came from, from 0
  double time = 0;    // seconds
  int recording = 0;  // Reset() and clocks set back begin the next: times grow within each
  bool tracked = false;
  MapId map;           // whose world the pose is in: none when not tracked
  Se3 T_world_camera;  // corrected by all that was learnt since
  // The frame had no pose when it was done, and got one later (of one camera: frames before the
  // start).
  bool late = false;
  Se3 T_world_camera_live;  // as it was when the frame was done; of no meaning when late
  // The same told by the keyframe it hangs on (living, or culled and followed by another, see
  // MapState::culled), with lengths as if that one's scale were 1: what a correction leaves alone.
  KeyFrameId reference;
  Se3 T_reference_camera;
};

// A feature of a frame, and what became of it.
struct FeatureUse {
  float x = 0, y = 0;            // raw pixels
  float static_probability = 1;  // 0…1
  bool matched = false;          // the pose agrees with the landmark it shows
  // The landmark it shows is new: made with the newest keyframe or the one before (a mapper in its
  // own thread is one behind). If the frame is that keyframe, the pose may know nothing of it yet.
  bool fresh = false;
};

// What the detector answered last.
struct ShownDetections {
  int frames_ago = 0;      // how many frames before the last one it was given the picture, …
  double seconds_ago = 0;  // … and how long before it that one was taken, by the images' clock
  std::vector<Detection> detections;  // pixels of that picture, which is of the camera's size
  std::vector<std::string> names;     // of each: what its class is called
};

// Milliseconds, one sample per frame (map, loop, semidense: per keyframe). Of more than 262,144
// (2.4 hours at 30 frames a second) a part, drawn evenly: see SampleLog.
struct StageTimes {
  std::vector<double> frame, extract, track, map, loop, semidense;
  std::vector<double> detect;    // per frame the detector was given
  std::vector<double> dynamics;  // flow, geometry and belief, not the detector
};

// The newest reading of each, and how many there were: a stage whose number has not grown has not
// run since one asked last.
struct LatestTimes {
  SampleLog::Reading frame, extract, track, map, loop, semidense, detect, dynamics;
};

// Frames that Trajectory() has no longer (settings.trajectory.keep_seconds).
struct LetGoFrames {
  int frames = 0;
  int tracked = 0;  // of those, as it was when they were done
};

struct SlamCounts {
  int relocalisations = 0, loops = 0, merges = 0;
  int cuts = 0;       // gaps and jumps of the time, and calls of Reset()
  int predicted = 0;  // frames of TrackResult::predicted
  LetGoFrames let_go;
};

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
