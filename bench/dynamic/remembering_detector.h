// A detector that is asked the same pictures again and again answers each once.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "alidade/detect/detector.h"

namespace alidade::bench {

// One thread at a time. Pictures are told apart by size and a hash of their bytes.
class RememberingDetector : public Detector {
 public:
  explicit RememberingDetector(std::shared_ptr<Detector> detector)
      : detector_(std::move(detector)) {}
  std::vector<Detection> Detect(const cv::Mat& image) override;
  const std::vector<std::string>& ClassNames() const override { return detector_->ClassNames(); }
  // What the network took, one for each picture it was given.
  const std::vector<double>& milliseconds() const { return milliseconds_; }

 private:
  std::shared_ptr<Detector> detector_;
  std::map<uint64_t, std::vector<Detection>> answers_;
  std::vector<double> milliseconds_;
};

}  // namespace alidade::bench
