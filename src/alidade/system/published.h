// What the driving thread publishes of the last processed frame and of the camera, for any thread.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <vector>

#include "alidade/base/timing.h"
#include "alidade/detect/detector.h"
#include "alidade/features/frame.h"
#include "alidade/geometry/camera.h"

namespace alidade {

// The last processed frame. Never changes once it is published.
struct LastFrame {
  std::shared_ptr<const Frame> frame;
  std::vector<LandmarkId> matches;
  cv::Mat belief_of_cells;  // probability of being static, one per cell; empty without dynamics
  cv::Size image_size;
  KeyFrameId keyframe;                                // the keyframe it became; invalid: none
  std::shared_ptr<const FrameDetections> detections;  // the newest answer; null: none so far
  double detections_age = 0;                          // seconds
};

// A value that one thread replaces and any thread reads.
template <typename Value>
class Published {
 public:
  Value Get() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return value_;
  }
  void Set(Value value) {
    const std::lock_guard<std::mutex> lock(mutex_);
    value_ = std::move(value);
  }

 private:
  mutable std::mutex mutex_;
  Value value_;
};

struct PipelineCounts {
  std::atomic<int> relocalizations{0}, predicted{0}, camera_changes{0};
};

}  // namespace alidade
