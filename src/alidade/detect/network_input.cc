#include "alidade/detect/network_input.h"

#include <array>

namespace alidade {

cv::Mat ToNetworkInput(const cv::Mat& picture, const InputConvention& convention) {
  const std::array<int, 4> shape = {1, 3, picture.rows, picture.cols};
  cv::Mat input(static_cast<int>(shape.size()), shape.data(), CV_32F);
  for (int channel = 0; channel < 3; ++channel) {
    cv::Mat plane(picture.rows, picture.cols, CV_32F, input.ptr<float>(0, channel)), bytes;
    cv::extractChannel(picture, bytes, convention.red_first ? 2 - channel : channel);
    bytes.convertTo(plane, CV_32F, convention.scale);
  }
  return input;
}

}  // namespace alidade
