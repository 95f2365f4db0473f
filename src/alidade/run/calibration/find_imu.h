// What a recording tells of its inertial sensor once its camera is known.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "alidade/io/frame_source.h"
#include "alidade/run/calibration/inertial_windows.h"
#include "alidade/system/settings.h"

namespace alidade {

// Maps the recording once with `camera`, by its images alone, and fits its readings to the path:
// the sensor's rotation and place in the camera, its clock and its biases, whatever the recording
// says of them. `go_on` is called with the number of frames after each; false ends the pass.
InertialFinding FindImu(std::unique_ptr<FrameSource> source, const Camera& camera,
                        SlamSettings settings, const std::function<bool(int)>& go_on);

// What was found, one quantity per line, with standard deviations, or "not observable" where the
// readings tell no more than was assumed.
std::vector<std::string> ImuInWords(const InertialFinding& finding);

// The model with what is observable marked as known, to be written. Without it nothing is.
ImuModel ObservableOf(const InertialFinding& finding);

}  // namespace alidade
