// What happens to the trajectory when a map of one camera is dropped because its scale is unknown.
#pragma once

#include <optional>

#include "alidade/map/map_store.h"
#include "alidade/system/frame_log.h"
#include "alidade/system/present_frame.h"

namespace alidade {

// Keeps the poses of keyframes' own frames when the map `gone` is dropped. A keyframe's frame is
// stored relative to the keyframe itself, the frames beside it relative to the keyframe that shares
// most landmarks with them; where both neighbors of a keyframe's frame are in another map, that
// frame is stored relative to the preceding frame's keyframe instead. For the newest frame the
// successor is not known yet: it is returned, to be placed if the next frame is found in that map.
std::optional<Reattachment> ReattachFrames(MapId gone, const MapStore& maps, FrameLog& log);

}  // namespace alidade
