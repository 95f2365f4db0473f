// The final state of a run, read from its files or a saved map, for the end of an MCAP file.
#pragma once

#include <optional>
#include <string>

#include "alidade/io/cloud.h"
#include "alidade/io/trajectory.h"
#include "alidade/run/sources/saved_map.h"

namespace alidade {

struct FinalState {
  Trajectory trajectory;                  // T_world_camera; empty: unknown
  std::optional<Cloud> landmarks, shape;  // in the same world
};

// Reads trajectory.txt, landmarks.ply and semidense.ply of a result folder if they exist. Throws
// Error (input) if one cannot be read.
FinalState FinalStateIn(const std::string& results);

// From one of the maps in a file: its keyframes and landmarks. Saved maps have no semi-dense depth.
FinalState FinalStateOf(const SavedMap& saved, const MapPart& part);

}  // namespace alidade
