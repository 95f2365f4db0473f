#include "alidade/detect/suppress.h"

#include <algorithm>

namespace alidade {

float Overlap(const cv::Rect2f& a, const cv::Rect2f& b) {
  const float shared = (a & b).area(), all = a.area() + b.area() - shared;
  return all > 0 ? shared / all : 0;
}

std::vector<Detection> SuppressOverlaps(std::vector<Detection> detections, float most) {
  std::stable_sort(detections.begin(), detections.end(),
                   [](const Detection& a, const Detection& b) { return a.score > b.score; });
  std::vector<Detection> kept;
  for (const Detection& detection : detections) {
    const bool taken = std::any_of(kept.begin(), kept.end(), [&](const Detection& better) {
      return better.class_id == detection.class_id && Overlap(better.box, detection.box) > most;
    });
    if (!taken) kept.push_back(detection);
  }
  return kept;
}

}  // namespace alidade
