// A picture that shows whether exported images, poses and points fit together.
#pragma once

#include <opencv2/core.hpp>

#include "alidade/run/export/training_images.h"

namespace alidade {

// TrainingSet::shown, CV_8UC3, and beside it the points in front of it as its camera sees them,
// near ones on top. Empty if no image was written.
cv::Mat TrainingPreview(const TrainingSet& set);

}  // namespace alidade
