// A detector that runs elsewhere, in a web page's Worker or on another machine, with results that
// arrive later. The owner passes them to Bring(); the SLAM system takes the newest.
#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/detect/detector.h"

namespace ALIDADE_API alidade {

class LateDetector : public Detector {
 public:
  explicit LateDetector(std::vector<std::string> class_names)
      : class_names_(std::move(class_names)) {}

  // Any thread. `answer.number` is the frame's number as counted by Slam::Track(), starting at
  // Slam::first_number(). A result that is not newer than the previous one is ignored. The best
  // kMostDetections are kept. Throws Error (input) for an invalid detection.
  void Bring(FrameDetections answer);
  std::optional<FrameDetections> TakeAnswer() override;

  bool AnswersLate() const override { return true; }
  // Throws Error (input): must not be called.
  std::vector<Detection> Detect(const cv::Mat& image) override;
  const std::vector<std::string>& ClassNames() const override { return class_names_; }

 private:
  const std::vector<std::string> class_names_;
  std::mutex mutex_;
  std::optional<FrameDetections> newest_;
  int last_ = -1;      // number of the last accepted result
  bool told_ = false;  // the user was warned of too many detections
};

}  // namespace alidade
