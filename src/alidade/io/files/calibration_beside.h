// Finds the calibration in the folder of a recording, by the names that tools give such files.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "alidade/io/calibration.h"
#include "alidade/io/files/open_source.h"

namespace alidade {

// Paths of the files in `folder` with a known name. Alidade's camera.yaml alone if it is there;
// otherwise those of other tools (camera_info.yaml, camchain*.yaml, transforms.json, ...), sorted.
std::vector<std::string> CalibrationFilesIn(const std::string& folder);

// The calibration in `folder` for images of `size` (pixels); nullopt: none. Files of other tools
// are not looked for when `options` give a camera or a field of view. The one that was found is
// told (Calibration::told). Of several that agree within kSameCalibration pixels the most complete
// is taken; throws Error (input) if several disagree. A file of another tool that cannot be read,
// or is for images of another aspect ratio, is left out with a warning. Throws Error (input) if
// camera.yaml cannot be read.
std::optional<Calibration> CalibrationBeside(const std::string& folder, cv::Size size,
                                             const SourceOptions& options);

// Pixels. Formats of the same camera differ by their rounding and by the lens models they know.
inline constexpr double kSameCalibration = 0.1;

}  // namespace alidade
