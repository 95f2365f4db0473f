// ROS 1 and ROS 2 recordings as frame sources.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "alidade/io/files/open_source.h"
#include "alidade/io/frame_source.h"
#include "alidade/io/wrappers.h"

namespace alidade {

struct OpenedBag {
  std::unique_ptr<FrameSource> source;  // without inertial readings
  std::optional<ImuRecording> imu;      // of the camera as mounted
};

// `source` must satisfy IsBagSource(). Frames are the messages of one image topic in the order of
// recording, with the times of their headers. The calibration is that of the options, else
// CameraInfo, else camera.yaml beside the file. Ignores `first` and `last` of the options: the
// caller clips. Throws Error (input or usage).
OpenedBag OpenBagSource(const std::string& source, const SourceOptions& options);

}  // namespace alidade
