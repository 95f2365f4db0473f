#include "alidade/io/media/pixels.h"

namespace alidade {

cv::Mat FramePixels::Converted(const AVFrame& frame) {
  if (frame.width <= 0 || frame.height <= 0) return {};
  const auto format = static_cast<AVPixelFormat>(frame.format);
  scaler_.reset(sws_getCachedContext(scaler_.release(), frame.width, frame.height, format,
                                     frame.width, frame.height, AV_PIX_FMT_BGR24, SWS_BICUBIC,
                                     nullptr, nullptr, nullptr));
  if (!scaler_) return {};
  // The scaler writes whole vectors: rows are as long as a multiple of 32 pixels, and one more.
  cv::Mat padded(frame.height + 1, (frame.width + 31) / 32 * 32, CV_8UC3);
  cv::Mat color = padded(cv::Rect(0, 0, frame.width, frame.height));
  uint8_t* const planes[] = {color.data, nullptr, nullptr, nullptr};
  const int strides[] = {static_cast<int>(color.step), 0, 0, 0};
  const int rows =
      sws_scale(scaler_.get(), frame.data, frame.linesize, 0, frame.height, planes, strides);
  return rows == frame.height ? color : cv::Mat();
}

}  // namespace alidade
