#include "alidade/detect/suppress.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "alidade/base/log.h"

namespace alidade {
namespace {

// A score that is not a number is the lowest.
bool Better(const Detection& a, const Detection& b) {
  return a.score > b.score || (std::isnan(b.score) && !std::isnan(a.score));
}

}  // namespace

float Overlap(const cv::Rect2f& a, const cv::Rect2f& b) {
  const float shared = (a & b).area(), all = a.area() + b.area() - shared;
  return all > 0 ? shared / all : 0;
}

std::vector<Detection> SuppressOverlaps(std::vector<Detection> detections, float most) {
  std::stable_sort(detections.begin(), detections.end(), Better);
  std::vector<Detection> kept;
  for (const Detection& detection : detections) {
    if (kept.size() > kMostDetections) break;
    const bool taken = std::any_of(kept.begin(), kept.end(), [&](const Detection& better) {
      return better.class_id == detection.class_id && Overlap(better.box, detection.box) > most;
    });
    if (!taken) kept.push_back(detection);
  }
  return kept;
}

void KeepBest(std::vector<Detection>& detections, bool& told) {
  if (detections.size() <= kMostDetections) return;
  if (!std::exchange(told, true))
    LogWarning("the detector found " + std::to_string(detections.size()) +
               " objects in one image: the " + std::to_string(kMostDetections) +
               " with the highest scores are used (further images are not reported)");
  std::stable_sort(detections.begin(), detections.end(), Better);
  detections.resize(kMostDetections);
  detections.shrink_to_fit();
}

}  // namespace alidade
