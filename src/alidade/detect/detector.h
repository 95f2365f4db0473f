// What kind of thing is where in an image, as a network trained for it says.
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
  cv::Rect2f box;     // pixels of the image given, inside it, from edge to edge: pixel i covers
                      // i to i + 1, its centre is i + 0.5 (as in cv::Rect, unlike keypoints)
};

// What was found in one frame.
struct FrameDetections {
  int number = 0;  // Frame::number
  std::vector<Detection> detections;
};

// One instance, one thread at a time.
class Detector {
 public:
  virtual ~Detector() = default;
  // `image`: CV_8UC3 (blue green red) or CV_8UC1, of any size. Best score first, each thing once.
  // Throws Error (input) when the network gives no usable answer.
  virtual std::vector<Detection> Detect(const cv::Mat& image) = 0;
  virtual const std::vector<std::string>& ClassNames() const = 0;

  // Of one that works elsewhere (late_detector.h): nobody calls Detect(), TakeAnswer() gives what
  // has come since it was asked last, the newest.
  virtual bool AnswersLate() const { return false; }
  virtual std::optional<FrameDetections> TakeAnswer() { return {}; }
};

}  // namespace alidade
