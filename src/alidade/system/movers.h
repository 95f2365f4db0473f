// Between tracking and the dynamic filter: what the filter needs from a tracked frame, and which
// keypoints may enter a keyframe.
#pragma once

#include <vector>

#include "alidade/dynamics/dynamic_filter.h"
#include "alidade/map/map_store.h"
#include "alidade/tracking/placed_frame.h"

namespace alidade {

// MapperSettings::young_static while moving objects are left out: the prior probability that a new
// landmark is static.
constexpr float kYoungStatic = 0.5f;

// Whether the matches of the keypoints that may enter the map suffice to tie a keyframe to it.
bool HoldsWithoutMovers(const PlacedFrame& placed);

// The world of poses that are stored relative to keyframe `reference`.
WorldId WorldOf(KeyFrameId reference, const MapSnapshot& map);

// The predicted pose, for DynamicFilter::Judge().
PoseGuess GuessOf(const PlacedFrame& placed, KeyFrameId reference, const MapSnapshot& map);

// Indices of the keypoints that may enter the map (Frame::kMappable), ascending.
std::vector<int> MappableKeypoints(const Frame& frame);

// Removes all other keypoints, with their matches, from the frame; if there are any, the picture,
// too.
void LeaveOutMovers(PlacedFrame& placed, const Camera& camera);

}  // namespace alidade
