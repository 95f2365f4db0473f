// Between the world of a map and that of its trajectory files: a rectified camera is turned against
// the camera as mounted, whose poses the files have.
#pragma once

#include <utility>
#include <vector>

#include "alidade/io/trajectory.h"
#include "alidade/map/map_store.h"
#include "alidade/run/sources/saved_map.h"

namespace alidade {

// A pose as written, and the keyframe that has it.
using KnownPose = std::pair<StampedPose, KeyFrameId>;

// Keyframes of one part of a map that have a pose in the trajectory (in order of time), by time.
std::vector<KnownPose> KeyFramesIn(const Trajectory& trajectory, const SavedMap& saved,
                                   const MapPart& part);

// Rotation R between both: p_written = R p_map. `known`: poses of keyframes as written. Identity if
// they are those of the map, or determine no rotation.
Eigen::Matrix3d WrittenTurn(const MapSnapshot& map, const std::vector<KnownPose>& known);

}  // namespace alidade
