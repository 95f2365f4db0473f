#include "alidade/stream/stream_scene.h"
#include "fuzz/targets.h"

namespace alidade::fuzz {

// Applies the message twice, because a message may refer to earlier content.
void Stream(std::string_view bytes) {
  StreamScene scene;
  scene.Take(bytes);
  scene.Take(bytes);
  for (const auto& [id, landmark] : scene.landmarks) {
    if (scene.keyframes.count(landmark.keyframe) != 0) scene.PointOf(landmark);
  }
}

}  // namespace alidade::fuzz
