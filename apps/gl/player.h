// Plays a recorded run at its original speed.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "alidade/run/recorder/stream_file.h"
#include "alidade/stream/stream_scene.h"

namespace alidade::gl_app {

class StreamPlayer {
 public:
  // A result folder or its run.stream. Throws Error (input) if there is none.
  explicit StreamPlayer(const std::string& what);

  // Processes the stream up to the frame `seconds` after the first one. Throws Error (input) for a
  // damaged file.
  void PlayTo(double seconds);
  bool ended() const { return ended_; }
  const StreamScene& scene() const { return scene_; }
  // The newest camera image, CV_8U gray, if it is new since the last call; else empty.
  cv::Mat TakePicture();
  // Text for the window: name, counts and state.
  std::string Title() const;

 private:
  StreamFileReader reader_;
  std::string name_;
  StreamScene scene_;
  std::string picture_;  // encoded; empty: no new one
  double first_ = 0;     // time of the first frame, seconds
  bool begun_ = false, ended_ = false;
};

}  // namespace alidade::gl_app
