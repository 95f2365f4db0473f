// Maps of several recordings become one where they show one place: recognised, verified and laid
// together as the maps of one recording are (looping/), then adjusted as a whole.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/map/map_file.h"
#include "alidade/map/map_union.h"

namespace ALIDADE_API alidade {

struct MapToMerge {
  std::string name;  // for errors
  SavedMap saved;
};

// Two worlds that became one.
struct MapJoin {
  KeyFrameId keyframe, place;  // of the merged map: `keyframe` sees what `place` saw
  int found = 0;               // landmarks of the place seen there …
  int visible = 0;             // … of so many that should be
};

struct MergedMaps {
  SavedMap saved;                 // with the camera and settings of the largest
  std::vector<UnitedPart> parts;  // what became of each map given, in that order
  std::vector<MapJoin> joins;
  int ties = 0;  // further places where joined maps were found to meet
};

// `what` is done for `done` of `total` keyframes. Called often.
using MergeProgress = std::function<void(const char* what, int done, int total)>;

// The result is the same whatever order the maps are given in: they are sorted by size (keyframes,
// landmarks, then their bytes), and the world of the largest is the common one. Maps that show no
// place of another's stay as they are, each in its own world. Every keyframe is asked for places of
// other maps, with all gates of LoopSettings, as the settings saved in the largest map have them.
// Throws Error: usage for fewer than two, input for maps that cannot be together: another sensor or
// camera (see CheckSameCamera), or one that is given twice.
MergedMaps MergeMaps(const std::vector<MapToMerge>& maps, const MergeProgress& progress = {});

}  // namespace alidade
