// A detector that returns detections set by the test.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/detect/detector.h"

namespace alidade {

class ScriptedDetector : public Detector {
 public:
  using Answer = std::function<std::vector<Detection>(const cv::Mat&)>;
  explicit ScriptedDetector(Answer answer,
                            std::vector<std::string> names = {"person", "chair", "toaster"})
      : answer_(std::move(answer)), names_(std::move(names)) {}
  std::vector<Detection> Detect(const cv::Mat& image) override { return answer_(image); }
  const std::vector<std::string>& ClassNames() const override { return names_; }

 private:
  Answer answer_;
  std::vector<std::string> names_;
};

}  // namespace alidade
