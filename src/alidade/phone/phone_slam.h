// The core as a page or a phone's app wants it: pictures in, a few numbers and the viewer's
// messages out; a camera nobody calibrated is found on the way.
#pragma once

#include <cstdint>
#include <memory>
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

// What is known after a frame.
struct PhoneFrame {
  TrackResult result;
  int number = 0;  // counted from 0
  int keyframes = 0, landmarks = 0, maps = 0;
  int features = 0, matches = 0;  // of the frame
  double milliseconds = 0;        // it took
  double fov = 0;                 // horizontal, degrees, as it is believed to be
  double fov_sigma = 0;           // degrees; 0: it was given
  int camera_changes = 0;         // how often the map was changed to another, found from it
};

class PhoneSlam {
 public:
  // `fov`: horizontal, degrees; 0: nothing is known, 66 along the longer side is where it begins.
  // Throws Error on what cannot be.
  PhoneSlam(int width, int height, double fov, PhoneSettings settings);
  // The same with a calibrated camera.
  PhoneSlam(const Camera& camera, PhoneSettings settings);
  ~PhoneSlam();

  // One picture: 1 (grey) or 4 (red green blue alpha) bytes a pixel, rows without gaps. `time` in
  // seconds. Throws Error on what Slam::Track() refuses.
  PhoneFrame Track(const uint8_t* pixels, int channels, double time);
  void Finish();
  // What a detector found in an earlier picture (PhoneFrame::number), in its pixels; it may come
  // many pictures late. Throws Error (input) on classes that were not named.
  void Detected(int number, std::vector<Detection> detections);
  Slam& slam() { return *slam_; }

  // The viewer's messages since they were taken last (src/alidade/stream). The first call begins
  // them; who takes none for long gets all that is known, anew.
  std::vector<std::string> TakeMessages();
  // For one who joins now: hello and all that is known. What TakeMessages() gives next goes on
  // from it.
  std::vector<std::string> WholeState();
  // TUM format: every frame that has a pose.
  std::string Trajectory() const;
  // Landmarks as a binary PLY point cloud.
  std::string Cloud() const;

 private:
  void Begin();
  void BeginMessages();
  void Tell(std::vector<std::string> messages);
  void TellLens(PhoneFrame& frame) const;

  PhoneSettings settings_;
  Camera camera_;
  bool known_;
  LatestTimes latest_;  // as the last frame left them
  int frames_ = 0;
  std::unique_ptr<Slam> slam_;
  std::shared_ptr<LateDetector> detector_;  // null: there is none
  StreamSource source_;
  std::unique_ptr<StreamEncoder> encoder_;  // null: nobody asked
  std::vector<std::string> messages_;
  size_t waiting_ = 0;   // bytes of messages_
  bool behind_ = false;  // some were dropped: nobody took them
};

}  // namespace alidade
