// Encodes images as packets of H.264 or H.265, and writes them as messages.
#pragma once

#include <gtest/gtest.h>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/opt.h>
}

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "bags/message_bytes.h"
#include "support/i420_frame.h"

namespace alidade {

struct VideoPacket {
  int frame = 0;  // in order of presentation
  std::string bytes;
};

// Without loss (but H.264 with B-frames), with a keyframe every 10 frames, and H.265 with
// checksums. `images`: CV_8UC3 of one even size. Empty when FFmpeg has no encoder.
inline std::vector<VideoPacket> EncodeVideo(const std::string& encoder,
                                            const std::vector<cv::Mat>& images, int b_frames = 0) {
  av_log_set_level(AV_LOG_QUIET);
  const AVCodec* found = avcodec_find_encoder_by_name(encoder.c_str());
  if (!found) return {};
  AVCodecContext* codec = avcodec_alloc_context3(found);
  codec->width = images.front().cols;
  codec->height = images.front().rows;
  codec->pix_fmt = AV_PIX_FMT_YUV420P;
  codec->time_base = {1, 30};
  codec->gop_size = 10;
  codec->max_b_frames = b_frames;
  const std::string parameters =
      "keyint=10:min-keyint=10:scenecut=0:repeat-headers=1:b-adapt=0:bframes=" +
      std::to_string(b_frames);
  if (encoder == "libx264") {
    av_opt_set(codec->priv_data, "qp", b_frames > 0 ? "4" : "0", 0);
    av_opt_set(codec->priv_data, "x264-params", parameters.c_str(), 0);
  } else {
    av_opt_set(codec->priv_data, "x265-params",
               (parameters + ":lossless=1:log-level=none:open-gop=0:hash=1").c_str(), 0);
  }
  std::vector<VideoPacket> packets;
  if (avcodec_open2(codec, found, nullptr) == 0) {
    AVFrame* frame = av_frame_alloc();
    AVPacket* packet = av_packet_alloc();
    for (size_t i = 0; i <= images.size(); ++i) {
      if (i < images.size()) {
        frame->format = codec->pix_fmt;
        frame->width = codec->width;
        frame->height = codec->height;
        av_frame_get_buffer(frame, 0);
        FillI420(images[i], frame);
        frame->pts = static_cast<int64_t>(i);
      }
      avcodec_send_frame(codec, i < images.size() ? frame : nullptr);
      av_frame_unref(frame);
      while (avcodec_receive_packet(codec, packet) == 0) {
        packets.push_back(
            {static_cast<int>(packet->pts),
             {reinterpret_cast<const char*>(packet->data), static_cast<size_t>(packet->size)}});
        av_packet_unref(packet);
      }
    }
    av_frame_free(&frame);
    av_packet_free(&packet);
  }
  avcodec_free_context(&codec);
  return packets;
}

// foxglove_msgs/CompressedVideo of ROS.
inline std::string VideoMessage(Dialect dialect, int64_t stamp, const std::string& frame,
                                const std::string& format, const std::string& data) {
  return MessageBytes(dialect.cdr, dialect.big_endian)
      .U32(static_cast<uint32_t>(stamp / 1'000'000'000))
      .U32(static_cast<uint32_t>(stamp % 1'000'000'000))
      .Text(frame)
      .Bytes(data)
      .Text(format)
      .Done();
}

// Fields of Protocol Buffers.
inline std::string ProtobufVarint(uint64_t value) {
  std::string bytes;
  for (; value > 127; value >>= 7) bytes += static_cast<char>(value | 128);
  return bytes + static_cast<char>(value);
}
inline std::string ProtobufBytes(int number, const std::string& bytes) {
  return static_cast<char>(number << 3 | 2) + ProtobufVarint(bytes.size()) + bytes;
}
inline std::string ProtobufTime(int number, int64_t stamp) {
  return ProtobufBytes(
      number, "\x08" + ProtobufVarint(static_cast<uint64_t>(stamp / 1'000'000'000)) + "\x10" +
                  ProtobufVarint(static_cast<uint64_t>(stamp % 1'000'000'000)));
}

// foxglove.CompressedVideo in Protocol Buffers.
inline std::string ProtobufVideoMessage(int64_t stamp, const std::string& frame,
                                        const std::string& format, const std::string& data) {
  return ProtobufTime(1, stamp) + ProtobufBytes(2, frame) + ProtobufBytes(3, data) +
         ProtobufBytes(4, format);
}

// foxglove.CameraCalibration in Protocol Buffers; `packed`: numbers in a row, as proto3 does.
inline std::string ProtobufCalibrationMessage(int64_t stamp, const InfoFields& info,
                                              bool packed = true) {
  const auto raw = [](const auto& value) {
    return std::string(reinterpret_cast<const char*>(&value), sizeof value);
  };
  const auto doubles = [&](int number, const auto& values) {
    std::string row, single;
    for (const double value : values) {
      row += raw(value);
      single += static_cast<char>(number << 3 | 1) + raw(value);
    }
    return packed ? ProtobufBytes(number, row) : single;
  };
  return ProtobufTime(1, stamp) + "\x15" + raw(info.width) + "\x1d" + raw(info.height) +
         ProtobufBytes(4, info.model) + doubles(5, info.D) + doubles(6, info.K) +
         doubles(7, info.R) + doubles(8, info.P) + ProtobufBytes(9, info.frame);
}

// foxglove_msgs/CameraCalibration of ROS.
inline std::string CalibrationMessage(Dialect dialect, int64_t stamp, const InfoFields& info) {
  MessageBytes bytes(dialect.cdr, dialect.big_endian);
  bytes.U32(static_cast<uint32_t>(stamp / 1'000'000'000))
      .U32(static_cast<uint32_t>(stamp % 1'000'000'000))
      .Text(info.frame)
      .U32(info.width)
      .U32(info.height)
      .Text(info.model)
      .U32(static_cast<uint32_t>(info.D.size()));
  for (const double d : info.D) bytes.F64(d);
  for (const double k : info.K) bytes.F64(k);
  for (const double r : info.R) bytes.F64(r);
  for (const double p : info.P) bytes.F64(p);
  return bytes.Done();
}

}  // namespace alidade
