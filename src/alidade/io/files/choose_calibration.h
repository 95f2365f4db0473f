// Chooses the calibration: the user's, the one found beside the images, or an assumed field of
// view.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "alidade/io/calibration.h"
#include "alidade/io/files/open_source.h"

namespace alidade {

struct ChosenCalibration {
  Calibration calibration;
  bool guessed = false;   // no calibration was found, or the field of view is only approximate
  std::string lens_told;  // see SourceInfo
};

// Horizontal field of view in degrees that is assumed without a calibration. kDefaultFovDegrees
// applies to the longer side; for an upright image the horizontal one is 2 atan(width / height
// tan(fov / 2)), 40 degrees at 9:16. Taking 66 degrees as the horizontal field of view would make a
// translation look like a rotation.
double AssumedFov(cv::Size size);

// Horizontal field of view in degrees of a full-frame image of `size`, from the lens's focal length
// in 35 mm equivalents: f = f35 × diagonal / 43.27 mm (CIPA DCG-001). Valid for upright images as
// well.
double FovOfFocalLength35(double millimetres, cv::Size size);

// Adapts a calibration to images of `size`: one for images of another size but the same aspect
// ratio is scaled, cx' = (cx + 0.5) s - 0.5, and one without a size gets it. Adds to `told`. Throws
// Error (input) for another aspect ratio, and for a distortion that folds inside the image.
// `with_right`: the right camera is used.
Calibration FitToSize(Calibration calibration, cv::Size size, bool with_right = true);

// `found`: calibration beside the images; with a camera file only its frame rate is used, where the
// file has none. `size`: size of the recording's images, pixels.
// `focal_length_35`: focal length stated by the recording, mm in 35 mm equivalents; 0: none. The
// calibration is adapted by FitToSize().
ChosenCalibration ChooseCalibration(const std::optional<Calibration>& found, cv::Size size,
                                    const SourceOptions& options, double focal_length_35 = 0);

}  // namespace alidade
