// Masks that a run wrote (`--write-masks`), for exported images.
#pragma once

#include <map>
#include <opencv2/core.hpp>
#include <string>

#include "alidade/io/frame_source.h"

namespace alidade {

class ImageMasks {
 public:
  // `folder`: of a result. Throws Error (usage) if it has no mask.txt.
  explicit ImageMasks(const std::string& folder);
  // Of the recorded image: CV_8U, 255 = of use, 0 = moving, as COLMAP and nerfstudio expect. All of
  // use where the run left nothing out or had no mask.
  cv::Mat Of(const SourceFrame& frame, cv::Size size) const;

 private:
  std::string folder_;
  std::map<std::string, std::string> files_;  // by time stamp
};

}  // namespace alidade
