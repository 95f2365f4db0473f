// Maps and their trajectories in another world: scaled, turned, shifted.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "alidade/io/trajectory.h"
#include "alidade/run/sources/saved_map.h"

namespace alidade {

// The pose of the same camera in the new world.
Se3 InNewWorld(const Se3& T_world_camera, const Sim3& T_new_world);
Trajectory InNewWorld(Trajectory trajectory, const Sim3& T_new_world);

// Moves one part of a map: p_new = T_new_map * p_map. What is known of its world moves with it;
// `known` replaces the meters, and what else it has.
void MoveMap(SavedMap& saved, const MapPart& part, const Sim3& T_new_map,
             const MapWorld& known = {});

// What is known of the world of one part; without a map: nothing.
MapWorld WorldOf(const SavedMap& saved, const MapPart& part);

// WrittenTurn() of the trajectory of that part in the result folder `folder`; identity without.
Eigen::Matrix3d WrittenTurnIn(const SavedMap& saved, const MapPart& part,
                              const std::string& folder);

// Rotation that makes z (`y_down`: -y) of the new world point against gravity: the smallest one.
Eigen::Matrix3d Upright(const Eigen::Vector3d& down, bool y_down);

}  // namespace alidade
