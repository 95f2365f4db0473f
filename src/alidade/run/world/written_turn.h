// Between the world of a map and that of its trajectory files: a rectified camera is turned against
// the camera as mounted, whose poses the files have.
#pragma once

#include <utility>
#include <vector>

#include "alidade/io/trajectory.h"
#include "alidade/map/map_store.h"

namespace alidade {

// Rotation R between both: p_written = R p_map. `known`: poses of keyframes as written. Identity if
// they are those of the map, or determine no rotation.
Eigen::Matrix3d WrittenTurn(const MapSnapshot& map,
                            const std::vector<std::pair<StampedPose, KeyFrameId>>& known);

}  // namespace alidade
