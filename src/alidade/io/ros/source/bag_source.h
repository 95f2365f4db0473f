// Recordings of ROS 1 and ROS 2 as sources of frames.
#pragma once

#include <memory>
#include <string>

#include "alidade/io/files/open_source.h"
#include "alidade/io/frame_source.h"

namespace alidade {

// `source`: what IsBagSource() knows. Frames are the messages of one image topic in the order they
// were written down, with the times of their headers. The calibration is that of the options, else
// of CameraInfo, else camera.yaml beside the file. `first` and `last` of the options are the
// caller's to see to.
std::unique_ptr<FrameSource> OpenBagSource(const std::string& source, const SourceOptions& options);

}  // namespace alidade
