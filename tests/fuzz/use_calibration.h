// Uses a calibration as a run does before and with its first frame.
#pragma once

#include "alidade/io/calibration.h"

namespace alidade::fuzz {

// An accepted calibration must prepare images of the right size and map keypoints to finite
// positions. Throws Error when it is invalid for every sensor. Scales down large cameras, which
// would take seconds.
void UseCalibration(Calibration calibration);

}  // namespace alidade::fuzz
