// Video files and live cameras.
#pragma once

#include <memory>
#include <string>

#include "alidade/io/files/open_source.h"
#include "alidade/io/frame_source.h"

namespace alidade {

// Mono. Frames have the video's presentation times, seconds, and stand upright. The calibration is
// camera.yaml in the video's folder unless the options say otherwise. `first` and `last` of the
// options are the caller's to see to.
std::unique_ptr<FrameSource> OpenVideoSource(const std::string& path, const SourceOptions& options);

// Times are seconds since the first picture.
std::unique_ptr<FrameSource> OpenLiveCameraSource(int number, const SourceOptions& options);

}  // namespace alidade
