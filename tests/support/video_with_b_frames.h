// Writes a video whose frames are stored in another order than they are shown (MPEG-4 Part 2 with
// B-frames), which OpenCV's writer cannot.
#pragma once

#include <gtest/gtest.h>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "support/i420_frame.h"

namespace alidade {

// `images`: CV_8UC3 of one even size; `times`: milliseconds, increasing.
inline void WriteVideoWithBFrames(const std::string& path, const std::vector<cv::Mat>& images,
                                  const std::vector<int>& times) {
  av_log_set_level(AV_LOG_ERROR);
  AVFormatContext* format = nullptr;
  ASSERT_GE(avformat_alloc_output_context2(&format, nullptr, nullptr, path.c_str()), 0);
  const AVCodec* encoder = avcodec_find_encoder(AV_CODEC_ID_MPEG4);
  ASSERT_TRUE(encoder);
  AVCodecContext* codec = avcodec_alloc_context3(encoder);
  codec->width = images.front().cols;
  codec->height = images.front().rows;
  codec->pix_fmt = AV_PIX_FMT_YUV420P;
  codec->time_base = {1, 1000};
  codec->gop_size = 12;
  codec->max_b_frames = 2;
  codec->bit_rate = 4'000'000;
  if (format->oformat->flags & AVFMT_GLOBALHEADER) codec->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  ASSERT_EQ(avcodec_open2(codec, encoder, nullptr), 0);
  AVStream* stream = avformat_new_stream(format, nullptr);
  stream->time_base = codec->time_base;
  avcodec_parameters_from_context(stream->codecpar, codec);
  ASSERT_GE(avio_open(&format->pb, path.c_str(), AVIO_FLAG_WRITE), 0);
  ASSERT_GE(avformat_write_header(format, nullptr), 0);
  AVPacket* packet = av_packet_alloc();
  const auto drain = [&] {
    while (avcodec_receive_packet(codec, packet) == 0) {
      av_packet_rescale_ts(packet, codec->time_base, stream->time_base);
      packet->stream_index = stream->index;
      packet->duration = stream->time_base.den / 30;  // or the edit list ends before the last frame
      av_interleaved_write_frame(format, packet);
    }
  };
  AVFrame* frame = av_frame_alloc();
  for (size_t i = 0; i < images.size(); ++i) {
    frame->format = codec->pix_fmt;
    frame->width = codec->width;
    frame->height = codec->height;
    ASSERT_EQ(av_frame_get_buffer(frame, 0), 0);
    FillI420(images[i], frame);
    frame->pts = times[i];
    ASSERT_EQ(avcodec_send_frame(codec, frame), 0);
    av_frame_unref(frame);
    drain();
  }
  avcodec_send_frame(codec, nullptr);
  drain();
  av_write_trailer(format);
  av_frame_free(&frame);
  av_packet_free(&packet);
  avcodec_free_context(&codec);
  avio_closep(&format->pb);
  avformat_free_context(format);
}

}  // namespace alidade
