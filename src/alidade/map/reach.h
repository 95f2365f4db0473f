// Motion gate for relocalization and loop closure: how far the camera can have moved while its pose
// was unknown. Distinguishes places that look alike (the two ends of a corridor), since a camera
// moves continuously.
#pragma once

#include <span>

#include "alidade/base/api.h"
#include "alidade/map/map_store.h"

namespace ALIDADE_API alidade {

// Limits the distance from the last known position to
//   floor * depth + (speed * fastest + depth_speed * depth) * seconds + drift * gone,
// with `fastest` the highest speed in the last `span` seconds, `depth` the median depth at the
// candidate place and `gone` the length of the path since that place was last observed. The closer
// a place is to this limit, the more of it must be matched.
struct ReachSettings {
  double speed = 2;          // times the fastest the camera was just before
  double span = 2;           // seconds that "just before" is
  double depth_speed = 0.1;  // of the median depth, per second: who stood may walk on
  double floor = 0.3;        // of the median depth
  double drift = 0.05;       // of the way: what tracking may be off by
  // For a place as far as that or farther (a film may be cut): the share of the landmarks that
  // should be seen that must be found, and of the keypoints there, how many must look like them
  // (between maps, see loop.min_merge_alike). Measured, found and alike: other parts of a corridor
  // .2 to .51 and .4 to .79; the same place a moment later .6 to .7 and .8 to .9, from elsewhere
  // .15 and .48.
  double plain_share = 0.6;
  double plain_alike = 0.85;
  // The share asked while lost where the camera was last in another map: no way speaks against a
  // place, nor for it. Measured: wrong .35, right .29 to .47.
  double elsewhere_share = 0.4;
  void Check() const;  // throws Error (usage) naming the field that cannot be
};

struct TimedPlace {
  double time = 0;         // seconds
  Eigen::Vector3d centre;  // camera center, world frame
};

// Squared ratio of the distance from the last position to the limit, at most 1: 0 means no
// objection to a camera at `to`. `way`: past positions, oldest first, in the world frame of `to`;
// returns 0 if it spans less than 0.2 s or ends after `to`. `depth`: median depth at `to`. `gone`:
// path length since the place was observed. All in map units.
double DoubtOf(std::span<const TimedPlace> way, const TimedPlace& to, double depth, double gone,
               const ReachSettings& settings);

// Length of the path between two keyframes of a map, along the keyframes with ids in between.
double WayBetween(const MapSnapshot& map, KeyFrameId a, KeyFrameId b);

}  // namespace alidade
