// Merges maps of several recordings that show the same place. Places are recognized, verified and
// aligned as between maps of one recording (looping/), then the whole map is adjusted.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/map/map_file.h"
#include "alidade/map/map_union.h"

namespace ALIDADE_API alidade {

struct MapToMerge {
  std::string name;  // for error messages
  SavedMap saved;
};

// Two maps that became one.
struct MapJoin {
  KeyFrameId keyframe, place;  // in the merged map: `keyframe` shows the same place as `place`
  int found = 0;               // landmarks of the place found in `keyframe`
  int visible = 0;             // landmarks of the place that should be visible in it
};

struct MergedMaps {
  SavedMap saved;                 // with the camera and settings of the largest map
  std::vector<UnitedPart> parts;  // one per given map, in the same order
  std::vector<MapJoin> joins;
  int ties = 0;  // further matches between joined maps
  // Pixels, per given map: how far its calibration was from the camera of the largest map, which
  // replaced it (WithCamera()); 0: the same camera.
  std::vector<double> camera_shifts;
};

// Why `other` cannot be merged with `first`, the larger one, in words; empty: it can. Maps of one
// camera without depth may have two calibrations of it (MayBeOneCamera()). The maps themselves are
// not looked at.
std::string WhyNotTogether(const SavedMap& first, const SavedMap& other);

// Progress: step `what` has processed `done` of `total` keyframes. Called for each keyframe.
using MergeProgress = std::function<void(const char* what, int done, int total)>;

// The result does not depend on the order of the maps: they are sorted by size (keyframes,
// landmarks, then their bytes), and merged maps are in the world of the largest one. A map that
// shows no place of another map stays unchanged in its own world. Every keyframe is matched with
// places of the other maps, with all gates of LoopSettings, as saved in the largest map. Throws
// Error: usage for fewer than two maps; input for maps of different sensors or cameras
// (WhyNotTogether()), or a map that is given twice.
MergedMaps MergeMaps(const std::vector<MapToMerge>& maps, const MergeProgress& progress = {});

}  // namespace alidade
