// Image pyramid of kPyramidLevels levels, each 1.2 times smaller than the previous one.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace alidade {

// Sizes of all levels; every side is at least one pixel.
std::vector<cv::Size> PyramidSizes(cv::Size image);

// All levels, 8-bit gray. Level 0 shares the data of `image`; the others overwrite `memory`, a
// pyramid of the same size, if it is given.
std::vector<cv::Mat> BuildPyramid(const cv::Mat& image, std::vector<cv::Mat> memory = {});

// Converts one coordinate between a level and level 0. Image borders coincide, hence the shift of
// half a pixel.
inline double ToLevelZero(double v, double scale) { return (v + 0.5) * scale - 0.5; }
inline double FromLevelZero(double v, double scale) { return (v + 0.5) / scale - 0.5; }

}  // namespace alidade
