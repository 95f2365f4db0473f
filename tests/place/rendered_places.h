// Keyframes of rendered rooms, small and fast to create.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "alidade/features/extractor.h"
#include "alidade/synth/recording.h"

namespace alidade {

using SharedFrame = std::shared_ptr<const Frame>;

// Frames `first`, first + step, … of a scene at a tenth of the usual frame rate: 57 frames per lap
// in the room.
inline std::vector<SharedFrame> RenderPlaces(const std::string& scene, int first, int step,
                                             int count) {
  SynthSettings settings;
  settings.scene = scene;
  settings.width = 320;
  settings.height = 240;
  settings.fps = 3;
  settings.noise = 2;
  const SynthRecording recording(settings);
  ExtractorSettings wanted;
  wanted.features = 400;
  Extractor extractor(wanted);
  std::vector<SharedFrame> frames;
  for (int i = 0; i < count; ++i) {
    const int number = first + i * step;
    frames.push_back(std::make_shared<Frame>(extractor.Extract(
        recording.Render(number).image, recording.camera(), recording.Time(number), number)));
  }
  return frames;
}

}  // namespace alidade
