// Owners of FFmpeg's objects, and decoded frames as images.
#pragma once

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libswscale/swscale.h>
}

#include <memory>
#include <opencv2/core.hpp>

namespace alidade {

struct CloseFfmpeg {
  void operator()(AVFormatContext* format) const { avformat_close_input(&format); }
  void operator()(AVCodecContext* codec) const { avcodec_free_context(&codec); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  void operator()(SwsContext* scaler) const { sws_freeContext(scaler); }
};
template <typename T>
using Owned = std::unique_ptr<T, CloseFfmpeg>;

// Converts frames to CV_8UC3, blue green red.
class FramePixels {
 public:
  // Empty when the pixels cannot be converted.
  cv::Mat Converted(const AVFrame& frame);

 private:
  Owned<SwsContext> scaler_;
};

}  // namespace alidade
