// What a run does with a calibration before and with its first frame.
#pragma once

#include "alidade/io/calibration.h"

namespace alidade::fuzz {

// Calibrations that can be used at all must prepare pictures of the right size and put keypoints
// somewhere. Throws Error when it is of use for no sensor. A large camera is scaled down first: it
// would cost seconds.
void UseCalibration(Calibration calibration);

}  // namespace alidade::fuzz
