#include "alidade/detect/letterbox.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "alidade/base/error.h"

namespace alidade {
namespace {

constexpr int kMarginGrey = 114;
constexpr float kLeastSide = 2;  // pixels

}  // namespace

Letterbox FitInto(cv::Size image, cv::Size input) {
  if (image.empty() || input.empty()) ThrowInput("the detector got an empty image");
  const double scale = std::min(static_cast<double>(input.width) / image.width,
                                static_cast<double>(input.height) / image.height);
  Letterbox letterbox;
  letterbox.image = image;
  letterbox.input = input;
  const auto side = [scale](int length, int most) {
    return std::clamp(static_cast<int>(std::lround(scale * length)), 1, most);
  };
  letterbox.inner = {side(image.width, input.width), side(image.height, input.height)};
  letterbox.pad_left = (input.width - letterbox.inner.width) / 2;
  letterbox.pad_top = (input.height - letterbox.inner.height) / 2;
  return letterbox;
}

cv::Mat Apply(const Letterbox& letterbox, const cv::Mat& image) {
  cv::Mat color = image;
  if (image.channels() == 1) cv::cvtColor(image, color, cv::COLOR_GRAY2BGR);
  if (letterbox.inner == letterbox.image && letterbox.inner == letterbox.input) return color;
  cv::Mat fitted(letterbox.input, CV_8UC3, cv::Scalar::all(kMarginGrey));
  cv::Mat inner = fitted(
      {letterbox.pad_left, letterbox.pad_top, letterbox.inner.width, letterbox.inner.height});
  cv::resize(color, inner, letterbox.inner, 0, 0, cv::INTER_LINEAR);
  return fitted;
}

std::optional<cv::Rect2f> ToImage(const Letterbox& letterbox, const cv::Rect2f& box) {
  const auto back = [](float x, int pad, int inner, int image) {
    const float scaled = (x - static_cast<float>(pad)) * static_cast<float>(image) / inner;
    return std::clamp(scaled, 0.0f, static_cast<float>(image));
  };
  const auto back_x = [&](float x) {
    return back(x, letterbox.pad_left, letterbox.inner.width, letterbox.image.width);
  };
  const auto back_y = [&](float y) {
    return back(y, letterbox.pad_top, letterbox.inner.height, letterbox.image.height);
  };
  const float left = back_x(box.x), right = back_x(box.x + box.width);
  const float top = back_y(box.y), bottom = back_y(box.y + box.height);
  if (!(right - left >= kLeastSide && bottom - top >= kLeastSide)) return std::nullopt;
  return cv::Rect2f(left, top, right - left, bottom - top);
}

}  // namespace alidade
