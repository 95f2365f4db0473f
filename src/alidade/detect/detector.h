// Object detections in an image, and the interface of detector networks.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

struct Detection {
  int class_id = -1;  // index into Detector::ClassNames()
  float score = 0;    // 0…1
  // Pixels of the image passed to Detect(), clipped to it. Edges: pixel i covers i to i + 1 and its
  // center is i + 0.5 (as in cv::Rect, unlike keypoints).
  cv::Rect2f box;
};

// Detections of one frame.
struct FrameDetections {
  int number = 0;  // Frame::number
  std::vector<Detection> detections;
};

// Detections of one frame that are used. A picture hardly holds more objects; it is also the limit
// of YOLOv5's own program.
inline constexpr int kMostDetections = 300;

// Use each instance from one thread at a time.
class Detector {
 public:
  virtual ~Detector() = default;
  // `image`: CV_8UC3 (blue green red) or CV_8UC1, any size. Returns detections sorted by descending
  // score, with overlapping ones suppressed; the best kMostDetections are used. Throws Error
  // (input) when the network's output is unusable.
  virtual std::vector<Detection> Detect(const cv::Mat& image) = 0;
  virtual const std::vector<std::string>& ClassNames() const = 0;

  // true for a detector that runs elsewhere (late_detector.h): Detect() must not be called;
  // TakeAnswer() returns the newest result that arrived since the previous call, if any.
  virtual bool AnswersLate() const { return false; }
  virtual std::optional<FrameDetections> TakeAnswer() { return {}; }
};

}  // namespace alidade
