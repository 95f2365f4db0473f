// What is known of the world of one map beside its poses: the unit of its lengths, and the
// vertical.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/base/ids.h"

namespace ALIDADE_API alidade {

struct MapWorld {
  MapId map;
  // Lengths are meters by an inertial sensor or a survey. Those of depth cameras and stereo pairs
  // are meters without it.
  bool meters = false;
  double scale_sigma = 0;  // relative standard deviation of lengths; 0: unknown
  // Direction in which things fall, unit vector in the map's world; zero: unknown.
  Eigen::Vector3d down = Eigen::Vector3d::Zero();
  double down_sigma = 0;  // standard deviation of its direction, radians; 0: unknown

  bool KnowsDown() const { return !down.isZero(0); }
  bool operator==(const MapWorld&) const = default;
};

// `worlds` is sorted by map, with one entry per map at most. Null: nothing is known.
inline const MapWorld* FindWorld(const std::vector<MapWorld>& worlds, MapId map) {
  const auto at =
      std::find_if(worlds.begin(), worlds.end(), [&](const MapWorld& w) { return w.map == map; });
  return at == worlds.end() ? nullptr : &*at;
}

}  // namespace alidade
