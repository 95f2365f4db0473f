// Warns of radial distortion that the calibration does not model.
#pragma once

#include <string>

#include "alidade/calibration/lens_check.h"
#include "alidade/system/slam.h"

namespace alidade {

// Examines the map with the most keyframes. Returns no windows if there is no map, if a loaded map
// was only localized in, or if memory is exhausted.
LensCheck CheckLens(const Slam& slam, const SlamSettings& used, const LensCheckSettings& settings);

// The warning, with advice; empty: no reason to warn.
std::string LensInWords(const LensCheck& check, const Camera& camera);

}  // namespace alidade
