// Where the time of a frame goes: time of named parts of the work, for benchmarks. Where nobody
// measures, a timer costs the test of a pointer.
#pragma once

#include <array>
#include <chrono>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

// Parts of a frame's work in the driving thread, in the order in which they happen.
enum class FramePart {
  kNews,         // what the workers found; whether the pose is one to go on from
  kPrepare,      // conversion to gray, rectification, checks
  kInertial,     // what the readings of an inertial sensor tell
  kMovers,       // optical flow and moving objects, without the detector
  kBuffers,      // image copied, lists of corners joined, images released
  kPyramid,      // smaller images
  kSmooth,       // smoothed images
  kCorners,      // FAST corners, and the strong ones of each cell
  kSpread,       // corners spread over the image
  kDescribe,     // orientation, descriptor and exact position; undistortion
  kGrid,         // keypoints by place
  kDepth,        // depth of keypoints: depth image, or stereo matching
  kGlance,       // small copy of the image that start and relocalization compare
  kAlign,        // landmarks aligned with the image of the reference frame
  kLastFrame,    // landmarks of the last frame looked for
  kLocalMap,     // landmarks around gathered and projected
  kLocalSearch,  // and looked for
  kPassing,      // with depth: points of the last frames looked for
  kPose,         // pose from matches
  kEvidence,     // whether the pose is right
  kShutter,      // rolling shutter: what it did to keypoints, and what they tell of it
  kPlace,        // pose kept; keyframe decision; evidence for the mapper
  kKeyFrame,     // keyframe inserted
  kLeftOut,      // parts of the image that move with the camera
  kPublish,      // what callers may ask for
  kEarlier,      // frames from before the map
  kMapping,      // inline: mapping, loops and other workers' tasks
  kOther,        // not named
  kCount
};
constexpr int kFrameParts = static_cast<int>(FramePart::kCount);
// "prepare", "inertial", …
const char* NameOf(FramePart part);

// Measures the parts of what this thread does between construction and destruction, each without
// the parts inside it. At most one per thread.
class PartTimes {
 public:
  PartTimes();
  ~PartTimes();
  PartTimes(const PartTimes&) = delete;
  PartTimes& operator=(const PartTimes&) = delete;
  // Milliseconds of each part since the last call. Called outside all timers of this thread.
  std::array<double, kFrameParts> Take();

 private:
  friend class PartTimer;
  using Clock = std::chrono::steady_clock;
  // The part that has been running ends or is interrupted, and `part` runs. Returns the former.
  FramePart Switch(FramePart part);

  std::array<double, kFrameParts> milliseconds_{};
  FramePart running_ = FramePart::kOther;
  Clock::time_point since_ = Clock::now();
};

// From construction to destruction this thread works on `part`.
class PartTimer {
 public:
  explicit PartTimer(FramePart part) : times_(listening) {
    if (times_) before_ = times_->Switch(part);
  }
  ~PartTimer() {
    if (times_) times_->Switch(before_);
  }
  PartTimer(const PartTimer&) = delete;
  PartTimer& operator=(const PartTimer&) = delete;

 private:
  friend class PartTimes;
  static constinit thread_local PartTimes* listening;
  PartTimes* times_;
  FramePart before_ = FramePart::kOther;
};

}  // namespace alidade
