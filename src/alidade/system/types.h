// The values that go into and come out of Slam.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/base/ids.h"
#include "alidade/base/timing.h"
#include "alidade/detect/detector.h"
#include "alidade/geometry/se3.h"
#include "alidade/inertial/imu.h"
#include "alidade/inertial/preintegration.h"
#include "alidade/tracking/track_failure.h"

namespace ALIDADE_API alidade {

enum class TrackState {
  kInitializing,  // no map yet, or lost for so long that another map may start
  kTracking,
  kLost,
  kInitialising [[deprecated("use kInitializing")]] = kInitializing
};
// "initializing", "tracking" or "lost", as in every language and protocol.
constexpr const char* StateName(TrackState state) {
  constexpr const char* kNames[] = {"initializing", "tracking", "lost"};
  return kNames[static_cast<int>(state)];
}

// In the order that track() has in every language.
struct FrameInput {
  double time = 0;     // seconds
  cv::Mat image;       // 8-bit gray or BGR, of the camera's size
  cv::Mat right = {};  // stereo: the rectified right image
  // RGB-D: registered depth, CV_16U in units of 1 / camera.depth_factor metres or CV_32F in metres.
  // Empty: none.
  cv::Mat depth = {};
  cv::Mat color = {};  // `image` in color (BGR) when it is gray, for point clouds; empty: none
  // Readings of an inertial sensor since the last frame (Slam::SetImu()), in order of time. They
  // may run ahead of the image.
  std::vector<ImuSample> imu = {};
};

// How reliable a pose is.
struct PoseQuality {
  // That the pose is right, and not of another place that looks alike: from what was found of the
  // landmarks expected in the image, and where, and from the poses before (PoseEvidence). Of a
  // frame that starts a map: what is assumed of it (0.993).
  double probability = 0;
  // Covariance of the pose error in the camera frame: T_world_camera * Exp(xi) is the true pose
  // with xi = (translation; rotation) ~ N(0, covariance); m², m rad, rad² (one camera: map units).
  // From the normal equations of the pose, scaled by the residuals, and of the local map: the
  // covariance of the reference keyframe relative to the oldest keyframe of the last local bundle
  // adjustment. It does not include the drift of the map before that, and of a map that was loaded
  // only the first part. One camera: with the scale of the local map taken as exact, and too small
  // while its views differ by a few pixels only (docs/benchmarks/reliability.md).
  // Zero: unknown, or the first frame of a map, whose pose is the identity by definition.
  Matrix6d covariance = Matrix6d::Zero();
  // Landmarks that should be visible: of the local map, or, where the frame was aligned with an
  // earlier one (expert.tracker.align), of that frame.
  int expected = 0;
  int inliers = 0;  // of these, matched in agreement with the pose
  // inliers / expected, in [0, 1]; about a third of the local map is usual (occlusions), and nine
  // tenths of an earlier frame's.
  double found_share = 0;
};

// Orientation of the camera by an inertial sensor (docs/guides/inertial.md).
struct CameraOrientation {
  // The z axis of this world is up, and its x axis is the horizontal direction in which the camera
  // looked in the first frame (where it looked down or up: in which the upper or lower edge of the
  // image was).
  Eigen::Matrix3d R_world_camera = Eigen::Matrix3d::Identity();
  // Standard deviations, radians: of the vertical, along its less known direction, and of the angle
  // about the vertical since the first frame.
  double tilt_sigma = 0, heading_sigma = 0;
};

struct TrackResult {
  TrackState state = TrackState::kInitializing;
  Se3 T_world_camera;  // valid when tracking
  // Odometry: this camera's pose in that of the last frame with a pose, both by the map in which
  // this frame was tracked, so that corrections of the map in between are not part of it. nullopt:
  // no pose, or the frame does not continue the last one.
  std::optional<Se3> T_last_camera;
  // Lost: T_world_camera by dead reckoning, as long as it is known to a tenth of the distance of
  // what was seen; without an inertial sensor, or while the unit of the map is unknown,
  // extrapolated at constant velocity for tracker.predict_seconds. A guess: it is in no trajectory.
  std::optional<Se3> predicted;
  // With an inertial sensor, in every state, as soon as its rotation to the camera is known: given,
  // or found from about a second of turning. It continues after a gap in the images from a new
  // start.
  std::optional<CameraOrientation> orientation;
  int matches = 0;                             // landmarks that agree with the pose
  bool keyframe = false;                       // this frame became a keyframe
  TrackFailure failure = TrackFailure::kNone;  // why there is no pose
  const char* cut = "";  // why the frame does not continue the previous one; "": it does
  PoseQuality quality;   // valid when tracking; `covariance` also of a dead-reckoned `predicted`
  // Parts that failed and stopped (SlamHealth::Stopped()); repeated with every later frame.
  std::string warning;

  const char* reason() const { return ReasonText(failure); }  // `failure` in words; "" for none
};

// One frame of the finished trajectory.
struct FramePose {
  int index = 0;    // count of Track() calls before this frame's
  double time = 0;  // seconds
  int recording =
      0;  // increases with Reset() and when the clock is set back; times grow within one
  bool tracked = false;
  MapId map;           // the map whose world frame the pose is in; invalid when not tracked
  Se3 T_world_camera;  // after all corrections of the map so far
  // The frame had no pose when it was processed and got one later: for one camera, frames before
  // the start of the map.
  bool late = false;
  Se3 T_world_camera_live;  // the pose as Track() returned it; undefined when `late`
  // The pose relative to a keyframe (a living one: see MapState::culled), with lengths divided by
  // the keyframe's scale. Corrections of the map leave it unchanged.
  KeyFrameId reference;
  Se3 T_reference_camera;
};

// One feature of a frame and how it was used.
struct FeatureUse {
  float x = 0, y = 0;            // raw (distorted) pixels
  float static_probability = 1;  // in [0, 1]: that it is on something that does not move
  bool matched = false;          // its landmark agrees with the pose
  // Its landmark was created with the newest keyframe or the one before it.
  bool fresh = false;
};

// The detector's newest answer.
struct ShownDetections {
  int frames_ago = 0;      // frames between the detector's image and the last processed one
  double seconds_ago = 0;  // the same by the images' time stamps
  std::vector<Detection> detections;  // pixels of the detector's image, which has the camera's size
  std::vector<std::string> names;     // class name of each detection
};

// Milliseconds, one sample per frame (map, loop, semidense: per keyframe). From 262,144 samples on
// (2.4 hours at 30 frames per second) an evenly drawn subset: see SampleLog.
struct StageTimes {
  std::vector<double> frame, extract, track, map, loop, semidense;
  std::vector<double> detect;    // per frame given to the detector
  std::vector<double> dynamics;  // optical flow, geometry and belief, without the detector
};

// The newest sample of each stage and the count of samples. A stage whose count has not grown has
// not run since the last query.
struct LatestTimes {
  SampleLog::Reading frame, extract, track, map, loop, semidense, detect, dynamics;
};

// Frames that Trajectory() no longer holds (settings.trajectory.keep_seconds).
struct LetGoFrames {
  int frames = 0;
  int tracked = 0;  // of those, the ones that had a pose
};

struct SlamCounts {
  SlamCounts() {}  // user-provided, as in SlamSettings

  union {
    int relocalizations = 0;
    int relocalisations [[deprecated("use relocalizations")]];
  };
  int loops = 0, merges = 0;
  int cuts = 0;         // gaps and backward jumps of the time stamps, and calls of Reset()
  int predicted = 0;    // frames with TrackResult::predicted
  double left_out = 0;  // share of the image left out of every frame: Slam::LeaveOut(), fixed_parts
  LetGoFrames let_go;
};

// What images and inertial readings together tell so far (Slam::SetImu()).
struct InertialReport {
  bool given = false;      // SetImu() was called
  long samples = 0;        // readings so far
  bool metric = false;     // lengths of the newest map are meters because of the sensor
  double scale_sigma = 0;  // relative standard deviation of those lengths; 0: unknown
  // Direction in which things fall, unit vector in the world of the newest map.
  std::optional<Eigen::Vector3d> gravity;
  double gravity_sigma = 0;  // standard deviation of its direction, radians
  ImuBias bias;
  ImuModel model;                // as given, with what was estimated of it
  double rotation_sigma = 0;     // of model.T_camera_imu.R, radians; 0: given or unknown
  double time_offset_sigma = 0;  // seconds; 0: given or unknown
  std::string left_out;          // why the readings are not used, as a sentence; empty: they are
  std::string missing;           // what the readings do not tell yet, as a sentence; empty: nothing
};

}  // namespace alidade
