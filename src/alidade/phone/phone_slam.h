// Interface of the core for web pages and phone apps: images in; a few numbers and the viewer's
// messages out. An uncalibrated camera is self-calibrated online.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "alidade/detect/late_detector.h"
#include "alidade/stream/stream_encoder.h"
#include "alidade/system/slam.h"

namespace alidade {

struct PhoneSettings {
  SlamSettings slam;
  StreamSettings stream;
  // Of people and other things that move; goes with slam.dynamics.mode = full. Null: none.
  std::shared_ptr<Detector> detector;
  // Of a detector elsewhere, which answers through Detected(), instead; any: what it finds is left
  // out (dynamics.mode is full then, whatever it was).
  std::vector<std::string> detector_classes;
  // Lines of name=value, each as after --set. Throws Error (usage) on what cannot be.
  void SetLines(const std::string& lines);
  // The phone profile, in the order that a single thread does things unless `threaded`; at most so
  // many keyframes, since a page's memory is small.
  static PhoneSettings Default(bool threaded);
};

// Status after a frame.
struct PhoneFrame {
  TrackResult result;
  int number = 0;  // counted from 0
  int keyframes = 0, landmarks = 0, maps = 0;
  int features = 0, matches = 0;  // in this frame
  double milliseconds = 0;        // processing time of this frame
  double fov = 0;                 // current estimate of the horizontal field of view, degrees
  double fov_sigma = 0;           // degrees; 0: the field of view was given
  int camera_changes = 0;  // number of times the map was rebuilt with a new estimate of the camera
};

class PhoneSlam {
 public:
  // `fov`: horizontal field of view, degrees; 0: unknown, then self-calibration starts from 66
  // degrees along the longer side. Throws Error for invalid arguments.
  PhoneSlam(int width, int height, double fov, PhoneSettings settings);
  // The same with a calibrated camera.
  PhoneSlam(const Camera& camera, PhoneSettings settings);
  ~PhoneSlam();

  // Processes one image: 1 (gray) or 4 (red green blue alpha) bytes per pixel, rows without
  // padding. `time` in seconds. Throws Error as Slam::Track() does.
  PhoneFrame Track(double time, const uint8_t* pixels, int channels);
  // Readings of the device's inertial sensor since the last call, in its own axes (W3C
  // DeviceMotion: x right, y up, z out of the screen; any that are fixed to the camera will do), in
  // order of time on the clock of the images or one with a constant offset below a second. They are
  // used with the next image and may be ahead of it or behind.
  void Moved(std::span<const ImuSample> readings);
  void Finish();
  // Passes the detections in an earlier image (PhoneFrame::number), in its pixels. They may be many
  // images late. Throws Error (input) for a class that is not in PhoneSettings::detector_classes.
  // Ignored without detector_classes.
  void Detected(int number, std::vector<Detection> detections);
  Slam& slam() { return *slam_; }

  // Returns the viewer's messages (src/alidade/stream) since the previous call; the first call
  // starts the stream. After more than 32 MB were not taken, returns messages that restate the
  // whole map instead.
  std::vector<std::string> TakeMessages();
  // Messages for a viewer that joins now: hello and the whole state. Later messages of
  // TakeMessages() continue from there.
  std::vector<std::string> WholeState();
  // TUM format; all frames with a pose.
  std::string Trajectory() const;
  // The landmarks as a binary PLY point cloud.
  std::string Cloud() const;

 private:
  void Begin();
  void BeginMessages();
  void Tell(std::vector<std::string> messages);
  void TellLens(PhoneFrame& frame) const;

  PhoneSettings settings_;
  Camera camera_;
  bool known_;
  LatestTimes latest_;  // values after the previous frame
  int frames_ = 0;
  std::vector<ImuSample> moved_;  // readings since the last image
  std::unique_ptr<Slam> slam_;
  std::shared_ptr<LateDetector> detector_;  // null: no external detector
  StreamSource source_;
  std::unique_ptr<StreamEncoder> encoder_;  // null until messages are requested
  std::vector<std::string> messages_;
  size_t waiting_ = 0;   // size of messages_, bytes
  bool behind_ = false;  // messages were dropped because they were not taken
};

}  // namespace alidade
