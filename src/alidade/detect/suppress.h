// Non-maximum suppression: keeps the best of overlapping detections.
#pragma once

#include <vector>

#include "alidade/detect/detector.h"

namespace alidade {

// Intersection over union of two boxes, 0…1.
float Overlap(const cv::Rect2f& a, const cv::Rect2f& b);

// Greedy non-maximum suppression within each class: removes detections whose overlap with a better
// one exceeds `most`. Sorts by descending score; the order is stable.
// Ends at kMostDetections + 1, so that KeepBest() notices that there were more.
std::vector<Detection> SuppressOverlaps(std::vector<Detection> detections, float most);

// Keeps the kMostDetections with the highest scores, by descending score, where there are more; the
// order is stable. Warns if it removes any, unless `told`, which it then sets.
void KeepBest(std::vector<Detection>& detections, bool& told);

}  // namespace alidade
