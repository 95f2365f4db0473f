// The app's session without Java. Images arrive in the camera's thread, are processed in the
// session's thread, and the result is drawn in the screen's thread.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "alidade/phone/phone_slam.h"
#include "alidade/stream/stream_scene.h"
#include "scene_view.h"

namespace alidade {

// An invalid call in the current state: an image while the camera is gone.
class StateError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

// Lens parameters reported by the phone: empty (unknown, self-calibrated), the horizontal field of
// view in degrees (1 number), or fx fy cx cy k1 k2 p1 p2 k3 (9 numbers).
using LensNumbers = std::vector<double>;

// Status after the last processed frame.
struct SessionNumbers {
  PhoneFrame frame;
  InertialReport inertial;
  int frames = 0;   // processed images
  int skipped = 0;  // waiting images that were replaced by a newer one
  int failed = 0;   // images that were rejected or failed; Words() returns the reason
};

class CameraSession {
 public:
  // `settings`: lines of name=value, as after --set, on top of the phone profile. `detector`: ONNX
  // file of a network that detects people (docs/guides/detectors.md), "" for none; opened in the
  // session's thread, because that takes seconds. Throws Error for invalid arguments.
  CameraSession(int width, int height, const LensNumbers& lens, const std::string& settings,
                const std::string& detector);
  ~CameraSession();  // requires that no other call is running
  CameraSession(const CameraSession&) = delete;
  CameraSession& operator=(const CameraSession&) = delete;

  // Camera's thread. Passes the luma plane of one image: rows `row_stride` bytes apart, `bytes` in
  // total; `time` in seconds of the sensor's clock. Copies the plane and replaces an image that is
  // still waiting. Throws Error (input) when the plane is too small for the session's image size,
  // and StateError between CameraGone() and CameraBack().
  void Offer(const uint8_t* plane, size_t bytes, int row_stride, double time);
  // Sensor's thread. Readings of the inertial sensor since the last call (PhoneSlam::Moved()) on
  // the clock of the images, 7 numbers each: seconds, rad/s x y z, m/s² x y z. Throws Error (usage)
  // for another count.
  void Moved(std::span<const double> readings);
  // Call when the camera is lost: used by another app, activity paused, or device failed.
  void CameraGone();
  // The camera is available again: the next image starts a new recording in the same map.
  void CameraBack();

  // Screen's thread, with its GL context current.
  void SurfaceCreated();  // the context is new; objects of the previous one are lost
  void SurfaceGone();     // before the session ends, if the context lives longer
  // Gestures on the map: a drag in pixels, and a pinch (above 1: apart).
  void Turn(double right, double down) { view_->Turn(right, down); }
  void Zoom(double factor) { view_->Zoom(factor); }
  void SurfaceChanged(int width, int height);
  // `rotation`: clockwise degrees that make the image upright on the screen: 0, 90, 180 or 270.
  // Returns whether there was an image.
  bool Draw(int rotation);

  // Any thread.
  SessionNumbers Numbers() const;
  std::string Words() const;       // last problem; "" if none
  std::string Map() const;         // map.alidade; waits for the current frame, as Trajectory() does
  std::string Trajectory() const;  // TUM format
  void WaitUntilIdle() const;      // until no image is waiting or being processed

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

  mutable std::mutex slam_mutex_;  // held while a frame is processed or results are saved
  std::unique_ptr<PhoneSlam> slam_;
  // Session's thread only.
  Pixels working_;

  // Held briefly, to copy an image or move pointers.
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  Pixels waiting_, shown_;
  double waiting_time_ = 0;
  bool waits_ = false, in_work_ = false, end_ = false;
  bool gone_ = false, cut_ = false;
  std::vector<ImuSample> moved_;       // readings that no image has been processed with yet
  bool wanted_ = false;                // drawing is active, so messages are collected
  bool fresh_ = false;                 // shown_ has not been drawn yet
  std::vector<std::string> messages_;  // to be applied to scene_
  SessionNumbers numbers_;
  std::string words_;

  // Screen's thread only.
  std::unique_ptr<SceneView> view_;
  StreamScene scene_;
  Pixels drawn_;
  bool surface_ = false;
  int rotation_ = 0;  // of the last drawing

  std::thread thread_;
};

}  // namespace alidade
