// Whether the camera of a map bends what it should see straight: a lens nobody told of.
#pragma once

#include "alidade/base/api.h"
#include "alidade/map/map_store.h"
#include "alidade/map/measurement.h"

namespace ALIDADE_API alidade {

struct LensCheckSettings {
  int window = 10;       // keyframes in a row that are looked at together, …
  int least_window = 6;  // … so few where there are not enough for min_windows of these
  int min_windows = 3;   // that say something; with fewer nothing is said
  int max_windows = 40;  // at most, spread over the map: one takes some 5 ms
  int min_seen = 3;      // keyframes of a window that must see a landmark for it to count
  // Shift at the picture's corner, of its distance from the middle, from which a lens bends
  // strongly. Measured (docs/development/decisions/0009-lens-check.md): lenses that are told of or
  // bend little up to 0.04, one with k1 = -0.22 that nobody told of 0.09 to 0.11.
  double min_bend = 0.06;
  double min_sigmas = 3;  // that the median of the windows must be away from 0
  void Check() const;     // throws Error (usage) naming the field that cannot be
};

struct LensCheck {
  int windows = 0;  // that said something
  double k1 = 0;    // radial distortion on top of the camera's own, unitless: median of the windows
  double sigma = 0;     // its standard deviation, by what the windows differ
  double bend = 0;      // shift by k1 at the corner, of its distance from the middle
  bool strong = false;  // it bends strongly, beyond doubt
};

// Of the keyframes of one map, by EstimateLensBend(): windows of keyframes on end, each by itself,
// so that what they differ by says how far the median can be trusted.
LensCheck CheckLens(const MapSnapshot& map, MapId id, const Camera& camera,
                    const MeasurementNoise& noise, const LensCheckSettings& settings = {});

}  // namespace alidade
