// Cameras of Linux by Video4Linux (linux/videodev2.h), without another library.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "alidade/io/camera/camera_modes.h"
#include "alidade/io/camera/live_device.h"

namespace alidade {

// Devices that take pictures, in order of their numbers: "/dev/video0" to "/dev/video63". What
// cannot be opened is left out and told in `problems`, where not null.
std::vector<CameraDevice> FindCameras(std::vector<std::string>* problems = nullptr);

// Starts the mode that fits the request (ChooseMode()). Automatic focus and an exposure that slows
// the rate down in the dark are switched off until the camera is closed. `like`: where not null,
// the device wanted is the one of that name and, if there are several, on that bus, whatever its
// number is now. Throws Error: usage if the camera cannot do what was asked, input if it cannot be
// opened.
std::unique_ptr<LiveDevice> OpenV4l2Camera(const CameraRequest& request,
                                           const CameraDevice* like = nullptr);

}  // namespace alidade
