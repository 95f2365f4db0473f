// What has appeared where a depth camera saw through a moment ago: a vehicle that drives by, a
// person. It moves, so it must not enter the map. Bescos et al. 2018, §III-C, on a coarser grid.
#pragma once

#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/map/map_store.h"

namespace alidade {

// One per keypoint of a keyframe with depth: 1 if it lies on something that has appeared. Compared
// are the keyframes of its map up to `seconds` before it, and the last one before that, so that
// what has stood still since can be mapped. One of them saw through a keypoint if everything in the
// cells around its image (at least 16 pixels) was farther away, by more than 4 pixels of disparity
// (four standard deviations). Keypoints of similar depth, in the cells of the grid within 48
// pixels, decide together. All 0 for a camera without depth images.
std::vector<uint8_t> HasAppeared(const MapState& map, const Camera& camera, KeyFrameId keyframe,
                                 double seconds);

}  // namespace alidade
