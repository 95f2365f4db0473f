// Combines several maps into one store. Each keeps its own world frame; ids are shifted.
#pragma once

#include <span>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/map/map_store.h"

namespace ALIDADE_API alidade {

// Position of one map's objects in the union: new id = old id + first.
struct UnitedPart {
  uint32_t first_keyframe = 0, end_keyframe = 0;  // [first, end)
  uint32_t first_landmark = 0;
  uint32_t first_map = 0, end_map = 0;
  // Added to Frame::number, so that frame numbers of different maps are distinct.
  int first_frame = 0;
};

struct MapUnion {
  MapSnapshot map;
  std::vector<UnitedPart> parts;  // one per input map
  // Index of the input map that contains a keyframe.
  size_t PartOf(KeyFrameId id) const;
};

// Copies live objects only; ids of culled keyframes and merged landmarks must not be used with the
// union. Frames are copied (without images) if their number changes. Throws Error (input) if there
// are more objects than ids.
MapUnion Unite(std::span<const MapSnapshot> maps);

}  // namespace alidade
