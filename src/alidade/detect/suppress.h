// Each thing once: of detections that overlap, the best.
#pragma once

#include <vector>

#include "alidade/detect/detector.h"

namespace alidade {

// Area of the intersection over that of the union: 0…1.
float Overlap(const cv::Rect2f& a, const cv::Rect2f& b);

// Greedy non-maximum suppression within each class: leaves out what overlaps a better one by more
// than `most`. Best score first, equal ones as they stood.
std::vector<Detection> SuppressOverlaps(std::vector<Detection> detections, float most);

}  // namespace alidade
