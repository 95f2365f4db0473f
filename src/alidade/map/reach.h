// Motion gate for relocalization and loop closure: how far the camera can have moved while its pose
// was unknown. Distinguishes places that look alike (the two ends of a corridor), since a camera
// moves continuously.
#pragma once

#include <span>

#include "alidade/base/api.h"
#include "alidade/map/map_store.h"

namespace ALIDADE_API alidade {

struct Setting;

// Limits the distance from the last known position to
//   floor * depth + (speed * fastest + depth_speed * depth) * seconds + drift * gone,
// with `fastest` the highest speed in the last `span` seconds, `depth` the median depth at the
// candidate place and `gone` the length of the path since that place was last observed. The closer
// a place is to this limit, the more of it must be matched.
// Range, unit and meaning of the named fields: Table() in reach.cc.
struct ReachSettings {
  double speed = 2;
  // Seconds.
  double span = 2;
  // A person who stood may walk on.
  double depth_speed = 0.1;
  // Share of the median depth.
  double floor = 0.3;
  double drift = 0.05;
  // For a place at the limit or beyond (a recording may be cut): share of the landmarks expected in
  // view that must be found, and of the keypoints there whose descriptors must match. Other parts
  // of a corridor have 0.2 to 0.51 and 0.4 to 0.79; the same place a moment later 0.6 to 0.7 and
  // 0.8 to 0.9.
  double plain_share = 0.6;
  double plain_alike = 0.85;
  // The share asked while lost where the camera was last in another map, so that no path supports
  // or contradicts a place. Wrong ones have at most 0.35, correct ones 0.29 to 0.47.
  double elsewhere_share = 0.4;
  static std::span<const Setting> Table();
  void Check() const;  // throws Error (usage) naming the invalid setting
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

// Sum of the rotations between consecutive keyframes on that path, radians.
double TurnBetween(const MapSnapshot& map, KeyFrameId a, KeyFrameId b);

}  // namespace alidade
