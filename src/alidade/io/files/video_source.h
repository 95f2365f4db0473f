// Video files.
#pragma once

#include <memory>
#include <string>

#include "alidade/io/files/open_source.h"
#include "alidade/io/frame_source.h"

namespace alidade {

// A monocular source. Times are the video's presentation times in seconds; images are rotated
// upright. The calibration is camera.yaml in the video's folder unless the options specify another.
// Ignores `first` and `last` of the options: the caller clips. Throws Error (input) when the file
// cannot be read as a video.
std::unique_ptr<FrameSource> OpenVideoSource(const std::string& path, const SourceOptions& options);

}  // namespace alidade
