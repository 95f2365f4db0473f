// How far away things may be, by the landmarks a keyframe shows: the part of an epipolar line that
// is worth a search.
#pragma once

#include <span>
#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/map/map_store.h"
#include "alidade/semidense/depth_view.h"

namespace alidade {

class DepthRange {
 public:
  // By landmarks, and where they reach by the depth `views` already have.
  DepthRange(const MapSnapshot& map, const KeyFrame& keyframe, const Camera& camera,
             std::span<const DepthView> views);
  bool known() const { return !all_.empty(); }
  DepthInterval all() const { return all_; }
  // That of the depth nearby, or of the landmarks, where there are some, else of all.
  DepthInterval At(int x, int y) const { return cells_[(y / kCell) * columns_ + x / kCell]; }

 private:
  static constexpr int kCell = 8;  // pixels
  void SpanLandmarks(const MapSnapshot& map, const KeyFrame& keyframe);
  void SpanViews(const Camera& camera, std::span<const DepthView> views);

  int columns_ = 0, rows_ = 0;
  DepthInterval all_;
  std::vector<DepthInterval> cells_;
};

}  // namespace alidade
