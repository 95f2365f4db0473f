// Which calibration counts: what the user gave, what lies beside the images, or a guess.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "alidade/io/calibration.h"
#include "alidade/io/files/open_source.h"

namespace alidade {

struct ChosenCalibration {
  Calibration calibration;
  bool guessed = false;   // nothing was known, or a field of view that is only a guess
  std::string lens_told;  // SourceInfo's
};

// Horizontal field of view in degrees that is assumed when nothing is known. A phone's is that of
// its longer side: of an upright picture, the horizontal one is 2 atan(width / height tan(fov /
// 2)), 40 degrees for 9:16. Taken for the horizontal one, 66 makes a walk of a turn on the spot.
double AssumedFov(cv::Size size);

// Of the full picture of a lens with that focal length in 35 mm equivalents: f = f35 × diagonal /
// 43.27 mm (CIPA DCG-001), whichever way the picture is held.
double FovOfFocalLength35(double millimetres, cv::Size size);

// `focal_length_35`: what the recording says of its lens, mm; 0: nothing. For images of `size`;
// throws Error when the calibration is for another.
ChosenCalibration ChooseCalibration(const std::optional<Calibration>& found, cv::Size size,
                                    const SourceOptions& options, double focal_length_35 = 0);

}  // namespace alidade
