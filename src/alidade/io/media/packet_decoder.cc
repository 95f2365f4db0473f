#include "alidade/io/media/packet_decoder.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <thread>

#include "alidade/geometry/picture_size.h"
#include "alidade/io/media/pixels.h"

namespace alidade {
namespace {

class FfmpegDecoder : public PacketDecoder {
 public:
  bool Open(PacketCodec codec) {
    av_log_set_level(AV_LOG_QUIET);
    const AVCodec* decoder =
        avcodec_find_decoder(codec == PacketCodec::kH264 ? AV_CODEC_ID_H264 : AV_CODEC_ID_HEVC);
    if (!decoder) return false;
    codec_.reset(avcodec_alloc_context3(decoder));
    frame_.reset(av_frame_alloc());
    packet_.reset(av_packet_alloc());
    if (!codec_ || !frame_ || !packet_) return false;
    // Threads within a frame only: threads across frames would delay the images by their number.
    codec_->thread_count = static_cast<int>(std::thread::hardware_concurrency());
    codec_->thread_type = FF_THREAD_SLICE;
    codec_->max_pixels = kMostPixels;
    // An image with concealed damage would be taken for what the camera saw.
    codec_->err_recognition = AV_EF_CRCCHECK | AV_EF_BITSTREAM | AV_EF_BUFFER | AV_EF_EXPLODE;
    return avcodec_open2(codec_.get(), decoder, nullptr) == 0;
  }

  bool Send(const char* bytes, size_t size, int64_t number) override {
    if (size == 0 || size > std::numeric_limits<int>::max() / 2) return false;
    if (av_new_packet(packet_.get(), static_cast<int>(size)) != 0) return false;
    std::memcpy(packet_->data, bytes, size);
    packet_->pts = packet_->dts = number;
    const int sent = avcodec_send_packet(codec_.get(), packet_.get());
    av_packet_unref(packet_.get());
    return sent == 0;
  }

  bool End() override { return avcodec_send_packet(codec_.get(), nullptr) == 0; }

  Received Receive(int64_t& number, cv::Mat& color) override {
    const int received = avcodec_receive_frame(codec_.get(), frame_.get());
    if (received == AVERROR(EAGAIN) || received == AVERROR_EOF) return Received::kNone;
    if (received != 0) return Received::kDamaged;
    number = frame_->pts;
    const bool damaged =
        frame_->decode_error_flags != 0 || (frame_->flags & AV_FRAME_FLAG_CORRUPT) != 0;
    color = damaged ? cv::Mat() : pixels_.Converted(*frame_);
    av_frame_unref(frame_.get());
    return color.empty() ? Received::kDamaged : Received::kImage;
  }

  void Restart() override { avcodec_flush_buffers(codec_.get()); }

 private:
  Owned<AVCodecContext> codec_;
  Owned<AVFrame> frame_;
  Owned<AVPacket> packet_;
  FramePixels pixels_;
};

}  // namespace

std::unique_ptr<PacketDecoder> MakePacketDecoder(PacketCodec codec) {
  auto decoder = std::make_unique<FfmpegDecoder>();
  return decoder->Open(codec) ? std::move(decoder) : nullptr;
}

}  // namespace alidade
