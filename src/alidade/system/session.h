// The state of a run as a state machine: which state follows an event, and what the event makes
// useless and therefore erases. Session::Apply() is the only function that changes the state and
// the only one that erases what the system remembers of earlier frames.
#pragma once

namespace alidade {

class EarlyFrames;
class KeptFrames;
class MoverWatch;
class Tracker;
class YoungMap;

enum class SessionState {
  kSeeking,     // no pose; a known place is looked for, and a new map may start
  kConfirming,  // tracking in a map of one camera that the next frames must confirm
  kTracking,
  kLost  // no pose; a known place is looked for, and no new map may start yet
};

enum class SessionEvent {
  kMapLoaded,       // a saved map was loaded, before the first frame
  kDepthStart,      // one frame with depth started a map
  kTwoViewStart,    // two views of one camera started a map that is not confirmed yet
  kMapConfirmed,    // enough frames agreed with the unconfirmed map
  kMapRefused,      // the newest map turned out wrong: it is dropped
  kPoseLost,        // the frame's pose was not found
  kPoseResumed,     // a pose was found where the motion before the loss leads
  kRelocalized,     // a pose was found by descriptors, anywhere
  kLostForLong,     // lost for settings.new_map_seconds: another map may start
  kMapLeft,         // the map the camera was in is dropped: its scale is unknown, or it is unwanted
  kCut,             // the next frame need not continue the last one (gap in time, new recording)
  kRebuildStarted,  // the map is dropped, to be rebuilt from kept frames
  kFrameFailed      // an exception ended the frame
};

// What becomes useless with a transition.
struct Erasure {
  bool newest_map = false;      // the map started last is dropped; its frames may enter the next
  bool start_views = false;     // reference views of the two-view start
  bool motion = false;          // the last frame's pose and velocity
  bool passing_points = false;  // points tracked from frame to frame that are no landmarks
  bool moving_objects = false;  // beliefs about what moves in the image
  bool dynamics = false;        // everything the dynamic filter holds, which may be inconsistent
  bool waiting_frames = false;  // frames without a pose that would be localized in the next map
  bool kept_frames = false;     // frames kept to rebuild the map
};

struct Transition {
  SessionState next;
  Erasure erase;
};

// The whole state machine, but for kFrameFailed, after which Session restores the state from before
// the frame.
Transition After(SessionState state, SessionEvent event);

// What is erased by a Session. All of it is used by the driving thread only.
struct SessionMemory {
  YoungMap& young;
  EarlyFrames& early;
  KeptFrames& kept;
  Tracker& tracker;
  MoverWatch& movers;
};

class Session {
 public:
  explicit Session(const SessionMemory& memory) : memory_(memory) {}

  // `time`: of the present frame on the steady clock, seconds.
  void Apply(SessionEvent event, double time = 0);
  void BeginFrame() { before_frame_ = state_; }

  SessionState state() const { return state_; }
  bool has_pose() const {
    return state_ == SessionState::kConfirming || state_ == SessionState::kTracking;
  }
  // Valid in kLost: when the state began, steady clock, seconds; -infinity after kMapLoaded, so
  // that only informative frames are counted.
  double lost_since() const { return lost_since_; }
  // Frames since then whose image shows something.
  int informative_frames() const { return informative_frames_; }
  void CountInformativeFrame() { ++informative_frames_; }

 private:
  SessionMemory memory_;
  SessionState state_ = SessionState::kSeeking;
  SessionState before_frame_ = SessionState::kSeeking;
  double lost_since_ = 0;
  int informative_frames_ = 0;
};

}  // namespace alidade
