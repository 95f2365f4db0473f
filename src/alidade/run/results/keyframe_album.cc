#include "alidade/run/results/keyframe_album.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace alidade {

void KeyframeAlbum::Add(int index, const SourceFrame& frame, const Slam& slam) try {
  if (met_++ % step_ != 0) return;
  const cv::Mat& given = frame.color.empty() ? frame.image : frame.color;
  if (given.empty() || given.depth() != CV_8U) return;
  Page page{index, frame.time, {}, {}, slam.Features()};
  const double smaller = static_cast<double>(kWide) / given.cols;
  const cv::Size size(kWide, std::max(1, static_cast<int>(given.rows * smaller + 0.5)));
  cv::resize(given, page.image, size, 0, 0, cv::INTER_AREA);
  if (!frame.depth.empty()) cv::resize(frame.depth, page.depth, size, 0, 0, cv::INTER_NEAREST);
  const float scale = static_cast<float>(kWide) / static_cast<float>(slam.camera().width);
  for (FeatureUse& feature : page.features) {
    feature.x *= scale;
    feature.y *= scale;
  }
  pages_.push_back(std::move(page));
  if (pages_.size() < kMost) return;
  for (size_t i = 0; 2 * i < pages_.size(); ++i) std::swap(pages_[i], pages_[2 * i]);
  pages_.resize((pages_.size() + 1) / 2);
  step_ *= 2;
} catch (...) {  // std::bad_alloc, cv::Exception: images are optional
}

}  // namespace alidade
