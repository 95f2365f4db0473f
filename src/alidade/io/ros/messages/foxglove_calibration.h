// Calibrations as foxglove.CameraCalibration: the fields of sensor_msgs/CameraInfo without binning
// and region of interest.
#pragma once

#include <string_view>

#include "alidade/io/ros/messages/messages.h"

namespace alidade {

// Throws Error (input) when the message is damaged.
RosCameraInfo ParseFoxgloveCalibration(std::string_view message, Serialization serialization);

}  // namespace alidade
