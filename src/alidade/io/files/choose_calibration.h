// Which calibration counts: what the user gave, what lies beside the images, or a guess.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "alidade/io/calibration.h"
#include "alidade/io/files/open_source.h"

namespace alidade {

struct ChosenCalibration {
  Calibration calibration;
  bool guessed = false;  // of which a warning was given
};

// For images of `size`; throws Error when the calibration is for another.
ChosenCalibration ChooseCalibration(const std::optional<Calibration>& found, cv::Size size,
                                    const SourceOptions& options);

}  // namespace alidade
