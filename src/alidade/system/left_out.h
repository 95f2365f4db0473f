// Parts of the image that are never used: those that the user names, and those found to be fixed to
// the camera (dynamics/fixed_parts.h). Used by the driving thread.
#pragma once

#include <atomic>
#include <memory>
#include <opencv2/core.hpp>

#include "alidade/dynamics/fixed_parts.h"
#include "alidade/features/frame.h"
#include "alidade/geometry/camera.h"

namespace alidade {

class LeftOut {
 public:
  // `look`: whether fixed parts are looked for.
  LeftOut(const Camera& camera, bool look)
      : fixed_(camera), look_(look), size_(camera.width, camera.height) {}

  // `mask`: CV_8U, nonzero = left out, stretched over the image. Before the first frame.
  void Name(const cv::Mat& mask);
  // After each frame. True: a part that moves with the camera has been found since; the user is
  // told. `frame`: the features of `image`, without what is left out.
  bool See(const cv::Mat& image, const std::shared_ptr<const Frame>& frame);
  // Where the extractor looks for few features: here and on moving objects (CV_8U, any size; may be
  // empty).
  cv::Mat With(const cv::Mat& movers) const;
  // Removes the features, and marks the part in the thumbnail and in the mask of the picture.
  void RemoveFrom(Frame& frame, const Camera& camera) const;
  void SetCamera(const Camera& camera) { fixed_.SetCamera(camera); }
  void Cut() { fixed_.Cut(); }
  // Share of the image that is left out, 0 to 1. Any thread.
  double share() const { return share_; }

 private:
  void Update();

  FixedParts fixed_;
  bool look_;
  cv::Size size_;  // of the camera
  cv::Mat named_;
  cv::Mat all_;  // CV_8U, 255 = left out; empty: nothing is
  std::atomic<double> share_{0};
};

}  // namespace alidade
