// Images for FFmpeg's encoders.
#pragma once

#include <algorithm>
#include <opencv2/imgproc.hpp>

extern "C" {
#include <libavutil/frame.h>
}

namespace alidade {

// Fills a frame, whose format is AV_PIX_FMT_YUV420P and whose buffers exist, with an image of blue
// green red of its size.
inline void FillI420(const cv::Mat& image, AVFrame* frame) {
  cv::Mat planes;
  cv::cvtColor(image, planes, cv::COLOR_BGR2YUV_I420);
  const uint8_t* from = planes.data;
  for (int plane = 0; plane < 3; ++plane) {
    const int width = frame->width >> (plane > 0), height = frame->height >> (plane > 0);
    for (int y = 0; y < height; ++y, from += width)
      std::copy(from, from + width, frame->data[plane] + y * frame->linesize[plane]);
  }
}

}  // namespace alidade
