// What the app does, without Java: pictures come from the camera's thread, are worked on in one of
// the session's own, and what is known is drawn by the screen's.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "alidade/phone/phone_slam.h"
#include "alidade/stream/stream_scene.h"
#include "scene_view.h"

namespace alidade {

// A call that makes no sense as things stand: a picture while the camera is gone.
class StateError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

// What the phone tells of its lens: nothing (empty: assumed, and found on the way), the horizontal
// field of view in degrees (1 number), or fx fy cx cy k1 k2 p1 p2 k3 (9).
using LensNumbers = std::vector<double>;

// What is known after the last frame that was worked on.
struct SessionNumbers {
  PhoneFrame frame;
  int frames = 0;   // worked on
  int skipped = 0;  // pictures that came while another one still waited: the newer one won
  int failed = 0;   // pictures that the core refused or failed at: Words() says why
};

class CameraSession {
 public:
  // `settings`: lines of name=value, as after --set, over the phone profile. `detector`: an ONNX
  // file for people (docs/guides/detectors.md), "" for none; it is opened by the session's thread,
  // since that takes seconds. Throws Error on what cannot be.
  CameraSession(int width, int height, const LensNumbers& lens, const std::string& settings,
                const std::string& detector);
  ~CameraSession();  // when no other call is under way
  CameraSession(const CameraSession&) = delete;
  CameraSession& operator=(const CameraSession&) = delete;

  // The camera's thread. The luma plane of one picture: rows `row_stride` bytes apart, `bytes` in
  // all; `time` in seconds, the sensor's. It is copied (once) and waits for its turn, instead of
  // one that still waits. Throws Error (input) when the plane is too small for the size of the
  // session, StateError between CameraGone() and CameraBack().
  void Offer(const uint8_t* plane, size_t bytes, int row_stride, double time);
  // The camera is another app's, the activity was paused, the device failed.
  void CameraGone();
  // It is there again: the next picture begins a new recording, in the same map.
  void CameraBack();

  // The screen's thread, with its GL context current.
  void SurfaceCreated();  // the context is new: what was made in the one before is gone
  void SurfaceGone();     // before the session ends, where the context outlives it
  // The map: a finger moved so many pixels, or two of them went apart (above 1) or together.
  void Turn(double right, double down) { view_->Turn(right, down); }
  void Zoom(double factor) { view_->Zoom(factor); }
  void SurfaceChanged(int width, int height);
  // `rotation`: degrees, clockwise, that the picture is turned by to stand upright on the screen:
  // 0, 90, 180 or 270. Returns whether there was a picture.
  bool Draw(int rotation);

  // Any thread.
  SessionNumbers Numbers() const;
  std::string Words() const;       // what went wrong last; "" when all is well
  std::string Map() const;         // map.alidade; waits for the frame in work, as does the next
  std::string Trajectory() const;  // TUM format
  void WaitUntilIdle() const;      // until no picture waits or is in work

 private:
  using Pixels = std::vector<uint8_t>;

  void Work();
  void OpenDetectorFile();
  void WorkOn(double time, bool cut);
  void Fail(const std::string& what);

  const int width_, height_;
  const LensNumbers lens_;
  const std::string detector_;
  PhoneSettings settings_;

  mutable std::mutex slam_mutex_;  // held while a frame is worked on, and by who saves
  std::unique_ptr<PhoneSlam> slam_;
  // The session's thread alone.
  Pixels working_;

  // Held to copy a picture or to move a few pointers.
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  Pixels waiting_, shown_;
  double waiting_time_ = 0;
  bool waits_ = false, in_work_ = false, end_ = false;
  bool gone_ = false, cut_ = false;
  bool wanted_ = false;                // somebody draws: messages are taken
  bool fresh_ = false;                 // shown_ was not drawn yet
  std::vector<std::string> messages_;  // for the scene
  SessionNumbers numbers_;
  std::string words_;

  // The screen's thread alone.
  std::unique_ptr<SceneView> view_;
  StreamScene scene_;
  Pixels drawn_;
  bool surface_ = false;
  int rotation_ = 0;  // as drawn last

  std::thread thread_;
};

}  // namespace alidade
