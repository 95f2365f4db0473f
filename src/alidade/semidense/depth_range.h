// Range of inverse depths of a keyframe, from its landmarks. Limits the search along an epipolar
// line.
#pragma once

#include <span>
#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/map/map_store.h"
#include "alidade/semidense/depth_view.h"

namespace alidade {

class DepthRange {
 public:
  // From the keyframe's landmarks, narrowed by the depth of `views` where available.
  DepthRange(const MapSnapshot& map, const KeyFrame& keyframe, const Camera& camera,
             std::span<const DepthView> views);
  bool known() const { return !all_.empty(); }
  DepthInterval all() const { return all_; }
  // Range from depth nearby, else from landmarks nearby, else from all landmarks.
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
