#include "alidade/synth/texture.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace alidade {

Texture::Texture(const cv::Mat& grey) {
  CV_Assert(grey.type() == CV_8UC1 && !grey.empty());
  cv::Mat level = grey;
  while (true) {
    cv::Mat bordered;
    cv::copyMakeBorder(level, bordered, 1, 1, 1, 1, cv::BORDER_REPLICATE);
    images_.push_back(bordered);
    levels_.push_back(
        {level.cols, level.rows, static_cast<int>(bordered.step), bordered.ptr(1) + 1});
    if (level.cols == 1 && level.rows == 1) break;
    cv::Mat half;
    // Area averaging keeps all levels aligned with the first, for any size.
    cv::resize(level, half, {std::max(1, level.cols / 2), std::max(1, level.rows / 2)}, 0, 0,
               cv::INTER_AREA);
    level = half;
  }
}

}  // namespace alidade
