// What tracked frames mean to the dynamic filter, and what the filter's word means to keyframes.
#pragma once

#include <vector>

#include "alidade/dynamics/dynamic_filter.h"
#include "alidade/map/map_store.h"
#include "alidade/tracking/placed_frame.h"

namespace alidade {

// MapperSettings::young_static while moving objects are left out: the prior probability that a new
// landmark is static.
constexpr float kYoungStatic = 0.5f;

// Whether a frame is tied to the map by what stands still for certain: only that enters keyframes.
bool HoldsWithoutMovers(const PlacedFrame& placed);

// Whose world the poses that hang on a keyframe are in.
WorldId WorldOf(KeyFrameId reference, const MapSnapshot& map);

// Where the camera is, before movers are told apart.
PoseGuess GuessOf(const PlacedFrame& placed, KeyFrameId reference, const MapSnapshot& map);

// Keypoints that may enter the map, in order.
std::vector<int> MappableKeypoints(const Frame& frame);

// The frame without the others, their matches gone too; its picture is left out.
void LeaveOutMovers(PlacedFrame& placed, const Camera& camera);

}  // namespace alidade
