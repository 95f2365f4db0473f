// The image at eight sizes, each 1.2 times smaller than the one before.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace alidade {

// Of kPyramidLevels levels; no side gets below one pixel.
std::vector<cv::Size> PyramidSizes(cv::Size image);

// kPyramidLevels images, 8 bit grey. Level 0 is `image` itself (shared, not copied); no side gets
// below one pixel.
std::vector<cv::Mat> BuildPyramid(const cv::Mat& image);

// Pixel of level 0 that a position on a level shows, along one axis: image borders coincide, so
// pixel centres shift.
inline double ToLevelZero(double v, double scale) { return (v + 0.5) * scale - 0.5; }
inline double FromLevelZero(double v, double scale) { return (v + 0.5) / scale - 0.5; }

}  // namespace alidade
