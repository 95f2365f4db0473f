// Joins two maps of one camera that show nothing in common, by the motion between them as an
// inertial sensor tells it.
#pragma once

#include <optional>

#include "alidade/geometry/se3.h"
#include "alidade/inertial/motion_belief.h"

namespace ALIDADE_API alidade {

struct MapBridge {
  Sim3 T_a_b;           // points of map b into map a, each in its own units
  double sigma = 0;     // of the translation, meters, along its worst axis
  double rotation = 0;  // standard deviation of the rotation, radians, about its worst axis
};

// `in_a`: where dead reckoning from map a leads; `in_b`: the same sensor at the same time, as map b
// tells it. Rotation and position are those of dead reckoning; that both maps tell one velocity
// corrects the position, whose error comes mostly from the velocity. nullopt: velocities or the
// directions of gravity contradict each other (chi², 99.9 %).
std::optional<MapBridge> BridgeOf(const MotionBelief& in_a, const MotionBelief& in_b);

}  // namespace alidade
