// Tests whether the images have radial distortion that the camera model does not include.
#pragma once

#include <span>

#include "alidade/base/api.h"
#include "alidade/map/map_store.h"
#include "alidade/map/measurement.h"

namespace ALIDADE_API alidade {

struct Setting;

// Range, unit and meaning: Table() in lens_check.cc.
struct LensCheckSettings {
  int window = 10;
  int least_window = 4;
  int min_windows = 3;
  // Spread over the map. One takes some 5 ms.
  int max_windows = 40;
  int min_seen = 3;
  // Calibrated lenses and those with little distortion have up to 0.04, an undeclared k1 = -0.22
  // has 0.09 to 0.11 (decision 0009-lens-check).
  double min_bend = 0.06;
  double min_sigmas = 3;
  static std::span<const Setting> Table();
  void Check() const;  // throws Error (usage) naming the invalid setting
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
