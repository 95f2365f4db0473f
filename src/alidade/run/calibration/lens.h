// Says when a lens bends lines that it is taken to leave straight.
#pragma once

#include <string>

#include "alidade/calibration/lens_check.h"
#include "alidade/system/slam.h"

namespace alidade {

// Of the map with most keyframes. No windows where there is none, or a loaded map was only looked
// at, or there is no memory for it.
LensCheck CheckLens(const Slam& slam, const SlamSettings& used, const LensCheckSettings& settings);

// The warning, with what helps; empty when there is nothing to warn of.
std::string LensInWords(const LensCheck& check, const Camera& camera);

}  // namespace alidade
