// A recorded run, told as fast as it happened.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "alidade/run/recorder/stream_file.h"
#include "alidade/stream/stream_scene.h"

namespace alidade::gl_app {

class StreamPlayer {
 public:
  // A run's folder or its run.stream. Throws Error (input) when there is none.
  explicit StreamPlayer(const std::string& what);

  // Takes what was told until the frame at `seconds` after the first one. Throws Error (input) on a
  // damaged file.
  void PlayTo(double seconds);
  bool ended() const { return ended_; }
  const StreamScene& scene() const { return scene_; }
  // The camera's latest picture, CV_8U grey, if it came since the last call; else empty.
  cv::Mat TakePicture();
  // For the window: who, how many, in which state.
  std::string Title() const;

 private:
  StreamFileReader reader_;
  std::string name_;
  StreamScene scene_;
  std::string picture_;  // coded; empty: none that is new
  double first_ = 0;     // seconds, of the first frame
  bool begun_ = false, ended_ = false;
};

}  // namespace alidade::gl_app
