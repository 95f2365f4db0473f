// Non-maximum suppression: keeps the best of overlapping detections.
#pragma once

#include <vector>

#include "alidade/detect/detector.h"

namespace alidade {

// Intersection over union of two boxes, 0…1.
float Overlap(const cv::Rect2f& a, const cv::Rect2f& b);

// Greedy non-maximum suppression within each class: removes detections whose overlap with a better
// one exceeds `most`. Sorts by descending score; the order is stable.
std::vector<Detection> SuppressOverlaps(std::vector<Detection> detections, float most);

}  // namespace alidade
