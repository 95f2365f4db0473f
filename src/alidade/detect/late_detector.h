// A detector that works somewhere else and answers when it can: in a page's Worker, on another
// machine. Who has its answers brings them here; the system takes the newest.
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

  // Any thread. `answer.number`: the frame's, counted by Slam::Track() from Slam::first_number()
  // on. One that is older than what came before changes nothing.
  void Bring(FrameDetections answer);
  std::optional<FrameDetections> TakeAnswer() override;

  bool AnswersLate() const override { return true; }
  std::vector<Detection> Detect(const cv::Mat& image) override;  // throws Error: nobody may ask
  const std::vector<std::string>& ClassNames() const override { return class_names_; }

 private:
  const std::vector<std::string> class_names_;
  std::mutex mutex_;
  std::optional<FrameDetections> newest_;
  int last_ = -1;  // number of the last that was brought
};

}  // namespace alidade
