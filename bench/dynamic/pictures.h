// Pictures of the features of a frame and what became of them, as in the papers.
#pragma once

#include <opencv2/core.hpp>
#include <span>

#include "alidade/slam.h"

namespace alidade::bench {

// `image`: grey or blue green red. Green rings: features in use; orange crosses: left out; a blue
// line round the mask of movers (255, of any size; may be empty). Features are in pixels of an
// image `width` wide. CV_8UC3.
cv::Mat DrawFeatures(const cv::Mat& image, const cv::Mat& movers,
                     std::span<const FeatureUse> features, int width);

}  // namespace alidade::bench
