// Gives keyframes the motion since the one before them (KeyFrame::motion), once enough is known of
// an inertial sensor and of the map.
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "alidade/inertial/inertial_fit.h"
#include "alidade/map/map_store.h"

namespace alidade {

class KeyFrameMotions {
 public:
  using Motions = std::vector<std::pair<KeyFrameId, std::shared_ptr<const KeyFrameMotion>>>;
  // Of the keyframes of map `in` that have none yet and whose time the readings cover. `fit`: in
  // that map. `doubted`: time of an image, seconds; the readings before it are of no use.
  Motions Missing(const MapSnapshot& map, MapId in, const InertialFit& fit,
                  std::span<const ImuSample> samples, double doubted);

 private:
  KeyFrameId next_{0};  // keyframes before it were looked at
  MapId map_;
};

}  // namespace alidade
