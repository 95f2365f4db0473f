// A rendered room with walking people, with exact poses, depth and masks.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "alidade/synth/recording.h"

namespace alidade {

struct WalkedRoom {
  Camera camera;
  std::vector<RenderedFrame> frames;
  std::vector<Se3> T_camera_world;
};

struct WalkedRoomSettings {
  int actors = 2, frames = 60;
  bool stereo = false;
  uint64_t seed = 1;
};

// Renders at 320 × 240, about 10 ms per frame.
inline WalkedRoom WalkRoom(const WalkedRoomSettings& asked) {
  SynthSettings settings;
  settings.frames = asked.frames;
  settings.actors = asked.actors;
  settings.stereo = asked.stereo;
  settings.seed = asked.seed;
  settings.width = 320;
  settings.height = 240;
  const SynthRecording recording(settings);
  WalkedRoom room;
  room.camera = recording.camera();
  for (int i = 0; i < asked.frames; ++i) {
    room.frames.push_back(recording.Render(i));
    room.T_camera_world.push_back(recording.Pose(i).Inverse());
  }
  return room;
}

inline double ShareOfMask(const cv::Mat& mask) {
  return static_cast<double>(cv::countNonZero(mask)) / static_cast<double>(mask.total());
}

// Intersection over union of two masks; 1 when both are empty.
inline double OverlapOf(const cv::Mat& a, const cv::Mat& b) {
  const int either = cv::countNonZero(a | b);
  return either == 0 ? 1 : static_cast<double>(cv::countNonZero(a & b)) / either;
}

}  // namespace alidade
