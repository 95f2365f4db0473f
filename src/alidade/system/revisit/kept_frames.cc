#include "alidade/system/revisit/kept_frames.h"

#include <utility>

namespace alidade {

void KeptFrames::Add(const Frame& frame, int index, bool seeking) {
  if (!keeps()) return;
  if (static_cast<int>(frames_.size()) >= capacity_) {
    if (!seeking) {
      keeps_ = false;
      Clear();
      return;
    }
    frames_.pop_front();
  }
  auto kept = std::make_shared<Frame>(frame);
  kept->picture = nullptr;
  frames_.push_back({std::move(kept), index});
}

void KeptFrames::MapStarted(const Camera& camera, MapId map) {
  started_with_ = camera;
  map_ = map;
  complete_ = true;
}

void KeptFrames::Clear() {
  frames_.clear();
  complete_ = false;
}

}  // namespace alidade
