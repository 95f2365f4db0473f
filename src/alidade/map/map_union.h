// Several maps in one: each keeps its own world, ids are moved apart.
#pragma once

#include <span>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/map/map_store.h"

namespace ALIDADE_API alidade {

// Where the objects of one map have come to: id there + first = id here.
struct UnitedPart {
  uint32_t first_keyframe = 0, end_keyframe = 0;  // [first, end)
  uint32_t first_landmark = 0;
  uint32_t first_map = 0, end_map = 0;
  int first_frame = 0;  // added to Frame::number: those of the parts do not overlap
};

struct MapUnion {
  MapSnapshot map;
  std::vector<UnitedPart> parts;  // one for each map given
  // Which of the maps given a keyframe comes from.
  size_t PartOf(KeyFrameId id) const;
};

// Only what is alive is taken over: who still holds ids of what was culled or fused must not use
// them with the union. Frames are copied (without images) where their number changes. Throws Error
// (input) when there are more objects than ids.
MapUnion Unite(std::span<const MapSnapshot> maps);

}  // namespace alidade
