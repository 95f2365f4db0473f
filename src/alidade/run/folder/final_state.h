// What a run ended with, as its files or a saved map have it: what an MCAP file ends with.
#pragma once

#include <optional>
#include <string>

#include "alidade/io/cloud.h"
#include "alidade/io/trajectory.h"
#include "alidade/run/sources/saved_map.h"

namespace alidade {

struct FinalState {
  Trajectory trajectory;                  // T_world_camera; empty: not known
  std::optional<Cloud> landmarks, shape;  // in the same world
};

// trajectory.txt, landmarks.ply and semidense.ply of a folder of results, where they are there.
// Throws Error (input) when one cannot be read.
FinalState FinalStateIn(const std::string& results);

// Of one of the maps in a file: its keyframes and landmarks. Saved maps have no shape.
FinalState FinalStateOf(const SavedMap& saved, const MapPart& part);

}  // namespace alidade
