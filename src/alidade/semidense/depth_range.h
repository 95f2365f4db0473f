// How far away things may be, by the landmarks a keyframe shows: the part of an epipolar line that
// is worth a search.
#pragma once

#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/map/map_store.h"
#include "alidade/semidense/hypothesis.h"

namespace alidade {

class DepthRange {
 public:
  DepthRange(const MapSnapshot& map, const KeyFrame& keyframe, const Camera& camera);
  bool known() const { return !all_.empty(); }
  DepthInterval all() const { return all_; }
  // That of the landmarks nearby, where there are some, else of all.
  DepthInterval At(int x, int y) const { return cells_[(y / kCell) * columns_ + x / kCell]; }

 private:
  static constexpr int kCell = 32;  // pixels
  int columns_ = 0;
  DepthInterval all_;
  std::vector<DepthInterval> cells_;
};

}  // namespace alidade
