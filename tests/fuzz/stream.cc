#include "alidade/stream/stream_scene.h"
#include "fuzz/targets.h"

namespace alidade::fuzz {

// One message, taken twice: what is told may refer to what was told.
void Stream(std::string_view bytes) {
  StreamScene scene;
  scene.Take(bytes);
  scene.Take(bytes);
  for (const auto& [id, landmark] : scene.landmarks) {
    if (scene.keyframes.count(landmark.keyframe) != 0) scene.PointOf(landmark);
  }
}

}  // namespace alidade::fuzz
