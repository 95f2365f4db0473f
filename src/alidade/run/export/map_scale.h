// Meters for maps of one camera, from a distance that the user knows.
#pragma once

#include <string>
#include <vector>

#include "alidade/io/trajectory.h"
#include "alidade/run/sources/saved_map.h"

namespace alidade {

// The distance between two places of a map.
struct KnownDistance {
  // Each: time of a frame in seconds, as in trajectory.txt; landmark:ID; or x,y,z in the map's
  // world frame.
  std::string a, b;
  double meters = 0;
};

// Of the three words of --scale-by. Throws Error (usage) if the last is not a number.
KnownDistance KnownDistanceOf(const std::vector<std::string>& words);

// Meters per map unit. `trajectory`: of that part of the map; its frames may be named as well as
// keyframes. Throws Error (usage): a map that is in meters already; a place that is not understood,
// does not exist, or has no pose within 0.1 s; the same place twice; a distance that is not
// positive.
double MetersPerUnit(const SavedMap& saved, const MapPart& part, const Trajectory& trajectory,
                     const KnownDistance& known);

// Multiplies all lengths of one part of a map: poses, landmarks, semi-dense depth. They are meters
// then (MapWorld).
void ScaleMap(SavedMap& saved, const MapPart& part, double factor);

}  // namespace alidade
