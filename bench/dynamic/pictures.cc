#include "bench/dynamic/pictures.h"

#include <opencv2/imgproc.hpp>

#include "bench/dynamic/mask_scores.h"

namespace alidade::bench {

cv::Mat DrawFeatures(const cv::Mat& image, const cv::Mat& movers,
                     std::span<const FeatureUse> features, int width) {
  const cv::Scalar green(60, 220, 40), orange(0, 130, 255), blue(255, 120, 30);
  cv::Mat picture;
  if (image.channels() == 1) {
    cv::cvtColor(image, picture, cv::COLOR_GRAY2BGR);
  } else {
    picture = image.clone();
  }
  if (!movers.empty()) {
    cv::Mat mask;
    cv::resize(movers, mask, image.size(), 0, 0, cv::INTER_NEAREST);
    std::vector<std::vector<cv::Point>> outlines;
    cv::findContours(mask, outlines, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
    cv::drawContours(picture, outlines, -1, blue, 1);
  }
  const float scale = static_cast<float>(image.cols) / static_cast<float>(width);
  for (const FeatureUse& feature : features) {
    const cv::Point at(cvRound(feature.x * scale), cvRound(feature.y * scale));
    if (feature.static_probability >= kInUse) {
      cv::circle(picture, at, 2, green, 1, cv::LINE_AA);
    } else {
      cv::drawMarker(picture, at, orange, cv::MARKER_TILTED_CROSS, 5, 1, cv::LINE_AA);
    }
  }
  return picture;
}

}  // namespace alidade::bench
