// How far a camera can have come while nothing told where it went. A place that only looks like
// another (the two ends of a corridor) is told from it by that: cameras do not leap.
#pragma once

#include <span>

#include "alidade/base/api.h"
#include "alidade/map/map_store.h"

namespace ALIDADE_API alidade {

// From where a camera was last, it can be as far as
//   floor * depth + (speed * fastest + depth_speed * depth) * seconds + drift * gone:
// `fastest` in the `span` seconds before, `depth` the median depth where it is found, `gone` what
// it went since that place was seen. The farther of that a place is, the more of it must be seen
// for it to be believed.
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
  Eigen::Vector3d centre;  // of the camera, in the world
};

// What speaks against the camera being at `to`: the square of its distance from where it was, as a
// share of how far it can be; 1 at most. `way`: where the camera was, oldest first, in the world of
// `to`; when it is shorter than .2 s, or ends after `to`, nothing does: 0. `depth`: median, at
// `to`. `gone`: what it went since the place was seen; all in map units.
double DoubtOf(std::span<const TimedPlace> way, const TimedPlace& to, double depth, double gone,
               const ReachSettings& settings);

// Length of the way from one keyframe to another of its map, along the keyframes between, by id.
double WayBetween(const MapSnapshot& map, KeyFrameId a, KeyFrameId b);

}  // namespace alidade
