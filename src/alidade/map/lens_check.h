// Tests whether the images have radial distortion that the camera model does not include.
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
  int windows = 0;  // number of windows with a result
  // Radial distortion in addition to the camera model, unitless: median of the windows.
  double k1 = 0;
  double sigma = 0;  // standard deviation of k1, from the spread of the windows
  // Displacement by k1 at the image corner, relative to its distance from the center.
  double bend = 0;
  bool strong = false;  // significant and larger than min_bend
};

// Applies EstimateLensBend() to windows of consecutive keyframes of one map independently, so that
// their spread gives the standard deviation of the median.
LensCheck CheckLens(const MapSnapshot& map, MapId id, const Camera& camera,
                    const MeasurementNoise& noise, const LensCheckSettings& settings = {});

}  // namespace alidade
