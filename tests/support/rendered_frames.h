// Frames of a rendered recording, held in memory: one rendering serves all tests of a program.
#pragma once

#include <list>
#include <map>
#include <vector>

#include "alidade/synth/recording.h"

namespace alidade {

// One thread at a time.
class RenderedFrames {
 public:
  explicit RenderedFrames(const SynthSettings& settings) : recording_(settings) {}

  const SynthSettings& settings() const { return recording_.settings(); }
  const Camera& camera() const { return recording_.camera(); }
  Se3 Pose(int number) const { return recording_.Pose(number); }  // T_world_camera
  // Rendered by the first call with this number.
  const RenderedFrame& Frame(int number) {
    const auto found = frames_.find(number);
    if (found != frames_.end()) return found->second;
    return frames_.emplace(number, recording_.Render(number)).first->second;
  }

 private:
  SynthRecording recording_;
  std::map<int, RenderedFrame> frames_;
};

// The same object each time the settings are the same.
inline RenderedFrames& FramesOf(const SynthSettings& settings) {
  static std::list<RenderedFrames> all;
  for (RenderedFrames& frames : all) {
    if (frames.settings() == settings) return frames;
  }
  return all.emplace_back(settings);
}

// A furnished room, from the beginning of the path around it. 400 × 300 is about what a phone has.
inline RenderedFrames& SmallRoom(int width = 400, int height = 300) {
  SynthSettings settings;
  settings.width = width;
  settings.height = height;
  return FramesOf(settings);
}

}  // namespace alidade
