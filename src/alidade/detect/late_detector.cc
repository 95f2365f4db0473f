#include "alidade/detect/late_detector.h"

#include <cmath>

#include "alidade/base/error.h"
#include "alidade/detect/suppress.h"

namespace alidade {

void LateDetector::Bring(FrameDetections answer) {
  for (const Detection& detection : answer.detections) {
    if (detection.class_id < 0 || detection.class_id >= static_cast<int>(class_names_.size()))
      ThrowInput("a detection of class " + std::to_string(detection.class_id) + " of " +
                 std::to_string(class_names_.size()));
    const cv::Rect2f& box = detection.box;
    if (!(box.width >= 0 && box.height >= 0) || !std::isfinite(box.x + box.y) ||
        !std::isfinite(box.width + box.height) || !std::isfinite(detection.score))
      ThrowInput("a detection with impossible numbers");
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  if (answer.number <= last_) return;
  KeepBest(answer.detections, told_);
  last_ = answer.number;
  newest_ = std::move(answer);
}

std::optional<FrameDetections> LateDetector::TakeAnswer() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return std::exchange(newest_, std::nullopt);
}

std::vector<Detection> LateDetector::Detect(const cv::Mat&) {
  ThrowInput("this detector answers asynchronously");
}

}  // namespace alidade
