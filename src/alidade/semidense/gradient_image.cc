#include "alidade/semidense/gradient_image.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "alidade/features/color.h"

namespace alidade {
namespace {

// Pixels excluded at the image border, where gradients are extrapolated.
constexpr int kBorder = 3;

}  // namespace

GradientImageMaker::GradientImageMaker(const Camera& camera, double min_gradient,
                                       double gradient_weight)
    : min_gradient_(min_gradient), gradient_scale_(1 / std::sqrt(gradient_weight)) {
  if (camera.HasDistortion())
    MapFrom(camera, [&](const Eigen::Vector2d& pixel) { return camera.Distort(pixel); });
}

GradientImageMaker::GradientImageMaker(const Camera& from, const Camera& to, double min_gradient,
                                       double gradient_weight)
    : min_gradient_(min_gradient), gradient_scale_(1 / std::sqrt(gradient_weight)) {
  if (from.HasDistortion() || to.HasDistortion())
    MapFrom(to, [&](const Eigen::Vector2d& pixel) { return from.Undistort(to.Distort(pixel)); });
}

template <typename Where>
void GradientImageMaker::MapFrom(const Camera& camera, Where&& there) {
  cv::Mat x(camera.height, camera.width, CV_32F), y(camera.height, camera.width, CV_32F);
  cv::Mat seen(camera.height, camera.width, CV_8U);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector2d raw = there(Eigen::Vector2d(u, v));
      x.at<float>(v, u) = static_cast<float>(raw.x());
      y.at<float>(v, u) = static_cast<float>(raw.y());
      seen.at<uint8_t>(v, u) = raw.x() >= 0 && raw.y() >= 0 && raw.x() <= camera.width - 1 &&
                                       raw.y() <= camera.height - 1
                                   ? 255
                                   : 0;
    }
  }
  cv::convertMaps(x, y, map_x_, map_y_, CV_16SC2);
  const cv::Mat around = cv::Mat::ones(2 * kBorder + 1, 2 * kBorder + 1, CV_8U);
  cv::erode(seen, seen_, around);
}

GradientImage GradientImageMaker::Make(const Picture& picture) const {
  const auto straight = [&](const cv::Mat& image, int interpolation) {
    if (map_x_.empty() || image.empty()) return image;
    cv::Mat result;
    cv::remap(image, result, map_x_, map_y_, interpolation, cv::BORDER_REPLICATE);
    return result;
  };
  const cv::Mat gray = straight(picture.gray, cv::INTER_LINEAR);
  const cv::Mat color = straight(picture.color, cv::INTER_LINEAR);
  cv::Mat mask = straight(picture.mask, cv::INTER_NEAREST);
  // By one pixel, the support of the gradient.
  if (!mask.empty()) cv::dilate(mask, mask, cv::Mat());
  cv::Mat gx, gy, magnitude, angle;
  cv::Scharr(gray, gx, CV_32F, 1, 0, 1.0 / 32);
  cv::Scharr(gray, gy, CV_32F, 0, 1, 1.0 / 32);
  cv::cartToPolar(gx, gy, magnitude, angle);

  GradientImage image;
  image.values.create(gray.size(), CV_8UC2);
  image.direction.create(gray.size(), CV_8U);
  const auto scale = static_cast<float>(gradient_scale_);
  const float steps = GradientImage::kTurn / static_cast<float>(2 * CV_PI);
  const auto edge = static_cast<float>(min_gradient_);
  for (int y = 0; y < gray.rows; ++y) {
    const auto* g = gray.ptr<uint8_t>(y);
    const auto* m = magnitude.ptr<float>(y);
    const auto* a = angle.ptr<float>(y);
    const uint8_t* moving = mask.empty() ? nullptr : mask.ptr<uint8_t>(y);
    const uint8_t* seen = seen_.empty() ? nullptr : seen_.ptr<uint8_t>(y);
    auto* value = image.values.ptr<cv::Vec2b>(y);
    auto* direction = image.direction.ptr<uint8_t>(y);
    const bool inner_row = y >= kBorder && y < gray.rows - kBorder;
    for (int x = 0; x < gray.cols; ++x) {
      value[x] = {g[x], static_cast<uint8_t>(std::min(255.0f, m[x] * scale + 0.5f))};
      const bool usable = (!seen || seen[x]) && (!moving || !moving[x]);
      const int step = static_cast<int>(a[x] * steps + 0.5f) % GradientImage::kTurn;
      direction[x] = usable ? static_cast<uint8_t>(step) : GradientImage::kUnusable;
      if (m[x] < edge || !usable || !inner_row || x < kBorder || x >= gray.cols - kBorder) continue;
      image.edges.push_back({static_cast<uint16_t>(x), static_cast<uint16_t>(y)});
      const cv::Vec3b bgr = color.empty() ? cv::Vec3b::all(g[x]) : color.at<cv::Vec3b>(y, x);
      image.colors.push_back({bgr[2], bgr[1], bgr[0]});
    }
  }
  image.edges.shrink_to_fit();
  image.colors.shrink_to_fit();
  return image;
}

Picture GradientImage::Straight() const {
  Picture picture;
  cv::extractChannel(values, picture.gray, 0);
  picture.color = BgrOf(picture.gray);
  for (size_t i = 0; i < edges.size(); ++i)
    picture.color.at<cv::Vec3b>(edges[i].y, edges[i].x) = {colors[i][2], colors[i][1],
                                                           colors[i][0]};
  picture.mask = direction == kUnusable;
  return picture;
}

size_t GradientImage::bytes() const {
  return values.total() * values.elemSize() + direction.total() +
         edges.capacity() * sizeof(edges[0]) + colors.capacity() * sizeof(colors[0]);
}

}  // namespace alidade
