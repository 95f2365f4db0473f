#include "alidade/io/media/video_file.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/display.h>
}

#include <atomic>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <string_view>
#include <thread>

#include "alidade/io/media/pixels.h"

namespace alidade {
namespace {

// QuickTime metadata key that Apple phones write for the file or for a track.
constexpr char kFocalLengthKey[] = "com.apple.quicktime.camera.focal_length.35mm_equivalent";
constexpr int kMostDamaged = 4096;  // consecutive packets that cannot be decoded

double Millimetres(const AVDictionary* metadata) {
  const AVDictionaryEntry* entry = av_dict_get(metadata, kFocalLengthKey, nullptr, 0);
  double value = 0;  // not by strtod, which depends on the locale
  if (entry) std::from_chars(entry->value, entry->value + std::strlen(entry->value), value);
  return std::isfinite(value) && value > 0 ? value : 0;
}

// How the images are shown: turned clockwise by quarters, then mirrored left to right.
struct Orientation {
  int turns = 0;
  bool mirrored = false;
};

// From the display matrix, of which other parts (scale, shear) are ignored.
Orientation OrientationOf(const AVStream& stream) {
  const uint8_t* side_data = nullptr;
#if LIBAVFORMAT_VERSION_MAJOR >= 61
  const AVPacketSideData* side =
      av_packet_side_data_get(stream.codecpar->coded_side_data, stream.codecpar->nb_coded_side_data,
                              AV_PKT_DATA_DISPLAYMATRIX);
  if (side) side_data = side->data;
#else
  side_data = av_stream_get_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, nullptr);
#endif
  if (!side_data) return {};
  int32_t matrix[9];
  std::memcpy(matrix, side_data, sizeof matrix);
  Orientation shown;
  shown.mirrored = int64_t{matrix[0]} * matrix[4] < int64_t{matrix[1]} * matrix[3];
  if (shown.mirrored) av_display_matrix_flip(matrix, 1, 0);
  // av_display_rotation_get() returns the counterclockwise angle of the display.
  const double degrees = -av_display_rotation_get(matrix);
  if (std::isfinite(degrees))
    shown.turns = ((static_cast<int>(std::lround(degrees / 90)) % 4) + 4) % 4;
  return shown;
}

class VideoFile : public MediaStream {
 public:
  bool Open(const char* path, bool live) {
    av_log_set_level(AV_LOG_QUIET);
    AVFormatContext* format = avformat_alloc_context();
    if (!format) return false;
    AVDictionary* options = nullptr;
    awaits_complete_ = live;
    if (live) {
      format->interrupt_callback = {
          [](void* video) { return static_cast<VideoFile*>(video)->MustEnd() ? 1 : 0; }, this};
      av_dict_set(&options, "rtsp_transport", "tcp", 0);  // other protocols ignore it
      silent_since_ = Clock::now();
    }
    const int opened = avformat_open_input(&format, path, nullptr, &options);
    av_dict_free(&options);
    if (opened != 0) return false;
    format_.reset(format);
    if (avformat_find_stream_info(format, nullptr) < 0) return false;
    const AVCodec* decoder = nullptr;
    const int index = av_find_best_stream(format, AVMEDIA_TYPE_VIDEO, -1, -1, &decoder, 0);
    if (index < 0 || !decoder) return false;
    stream_ = format->streams[index];
    codec_.reset(avcodec_alloc_context3(decoder));
    if (!codec_ || avcodec_parameters_to_context(codec_.get(), stream_->codecpar) < 0) return false;
    codec_->pkt_timebase = stream_->time_base;
    codec_->thread_count = static_cast<int>(std::thread::hardware_concurrency());
    if (live) {  // threads that decode several frames at once would keep some back
      codec_->thread_type = FF_THREAD_SLICE;
      codec_->flags |= AV_CODEC_FLAG_LOW_DELAY;
    }
    if (avcodec_open2(codec_.get(), decoder, nullptr) < 0) return false;
    frame_.reset(av_frame_alloc());
    packet_.reset(av_packet_alloc());
    shown_ = OrientationOf(*stream_);
    return frame_ && packet_;
  }

  int FrameCount() const override {
    if (const int shown = IndexedFrames(); shown > 0) return shown;
    if (stream_->nb_frames > 0) return static_cast<int>(stream_->nb_frames);
    const double seconds = static_cast<double>(format_->duration) / AV_TIME_BASE;
    return seconds > 0 ? static_cast<int>(std::floor(seconds * FramesPerSecond() + 0.5)) : 0;
  }

  double FramesPerSecond() const override {
    AVRational rate = av_guess_frame_rate(format_.get(), stream_, nullptr);
    if (rate.num <= 0 || rate.den <= 0) rate = stream_->avg_frame_rate;
    return rate.num > 0 && rate.den > 0 ? av_q2d(rate) : 0;
  }

  double FocalLength35() const override {
    double focal = Millimetres(format_->metadata);
    for (unsigned i = 0; focal == 0 && i < format_->nb_streams; ++i)
      focal = Millimetres(format_->streams[i]->metadata);
    return focal;
  }

  void Interrupt() override { interrupted_ = true; }

  bool Grab() override {
    silent_since_ = Clock::now();
    for (int damaged = 0; damaged < kMostDamaged;) {
      const int received = avcodec_receive_frame(codec_.get(), frame_.get());
      if (received == 0) return TakeTime();
      if (received != AVERROR(EAGAIN)) {
        if (ended_ || received == AVERROR_EOF) return false;
        ++damaged;  // the decoder goes on with the next packet
      }
      if (!Send()) ++damaged;
    }
    return false;
  }

  double Time() const override { return time_; }

  cv::Mat Gray() override {
    color_ = pixels_.Converted(*frame_);
    if (color_.empty()) return {};
    cv::Mat gray;
    cv::cvtColor(color_, gray, cv::COLOR_BGR2GRAY);
    return Upright(gray);
  }

  cv::Mat Color() override {
    if (color_.empty()) return {};
    return shown_.turns == 0 && !shown_.mirrored ? color_.clone() : Upright(color_);
  }

  bool SeekNear(double time) override {
    const auto target = static_cast<int64_t>(std::floor(time / av_q2d(stream_->time_base)));
    if (av_seek_frame(format_.get(), stream_->index, target + Start(), AVSEEK_FLAG_BACKWARD) < 0)
      return false;
    avcodec_flush_buffers(codec_.get());
    ended_ = false;
    last_ = AV_NOPTS_VALUE;
    return true;
  }

 private:
  using Clock = std::chrono::steady_clock;

  // FFmpeg asks while it waits for the network.
  bool MustEnd() const {
    return interrupted_ ||
           std::chrono::duration<double>(Clock::now() - silent_since_).count() > kLongestSilence;
  }

  // Frames in the index of an MP4 file, without those that its edit list leaves out. 0: there is no
  // complete index, as in a fragmented file.
  int IndexedFrames() const {
    const std::string_view container = format_->iformat->name;
    if (container.find("mp4") == std::string_view::npos || stream_->nb_frames <= 0) return 0;
    int frames = 0;
    for (int i = 0; i < avformat_index_get_entries_count(stream_); ++i) {
      const AVIndexEntry* entry = avformat_index_get_entry(stream_, i);
      if (entry && (entry->flags & AVINDEX_DISCARD_FRAME) == 0) ++frames;
    }
    return frames;
  }

  int64_t Start() const { return stream_->start_time == AV_NOPTS_VALUE ? 0 : stream_->start_time; }

  // Gives the decoder the next packet of the stream, or tells it of the end; false when the packet
  // is damaged.
  bool Send() {
    while (!ended_) {
      const int read = av_read_frame(format_.get(), packet_.get());
      if (read == AVERROR(EAGAIN)) continue;
      if (read < 0) {
        ended_ = true;
        return avcodec_send_packet(codec_.get(), nullptr) == 0;
      }
      // A stream that was joined in its middle has no image before the next complete one.
      const bool complete = (packet_->flags & AV_PKT_FLAG_KEY) != 0;
      const bool of_stream =
          packet_->stream_index == stream_->index && (complete || !awaits_complete_);
      if (of_stream) awaits_complete_ = false;
      const int sent = of_stream ? avcodec_send_packet(codec_.get(), packet_.get()) : 0;
      av_packet_unref(packet_.get());
      if (of_stream) return sent == 0;
    }
    return true;
  }

  // The frame's own time if it is later than the last one's, else what FFmpeg makes of it.
  bool TakeTime() {
    const bool own =
        frame_->pts != AV_NOPTS_VALUE && (last_ == AV_NOPTS_VALUE || frame_->pts > last_);
    const int64_t stamp = own ? frame_->pts : frame_->best_effort_timestamp;
    if (own) last_ = stamp;
    time_ = stamp == AV_NOPTS_VALUE
                ? 0
                : static_cast<double>(stamp - Start()) * av_q2d(stream_->time_base);
    return true;
  }

  cv::Mat Upright(const cv::Mat& image) const {
    constexpr cv::RotateFlags kTurns[] = {cv::ROTATE_90_CLOCKWISE, cv::ROTATE_180,
                                          cv::ROTATE_90_COUNTERCLOCKWISE};
    cv::Mat upright = image;
    if (shown_.turns != 0) {
      cv::Mat turned;
      cv::rotate(upright, turned, kTurns[shown_.turns - 1]);
      upright = turned;
    }
    if (shown_.mirrored) {
      cv::Mat mirrored;
      cv::flip(upright, mirrored, 1);
      upright = mirrored;
    }
    return upright;
  }

  // Of a live stream; before format_, which uses them until it is closed.
  std::atomic<bool> interrupted_{false};
  Clock::time_point silent_since_;  // when the present wait began
  Owned<AVFormatContext> format_;
  Owned<AVCodecContext> codec_;
  Owned<AVFrame> frame_;
  Owned<AVPacket> packet_;
  FramePixels pixels_;
  AVStream* stream_ = nullptr;  // of format_
  cv::Mat color_;               // of the image that Gray() returned last
  Orientation shown_;
  int64_t last_ = AV_NOPTS_VALUE;  // latest time of a frame since the last seek
  double time_ = 0;                // of the grabbed frame, seconds
  bool awaits_complete_ = false;   // of a live stream: packets before a complete image
  bool ended_ = false;             // the decoder knows that no packet follows
};

}  // namespace

std::unique_ptr<MediaStream> OpenVideoFile(const char* path, bool live) {
  auto video = std::make_unique<VideoFile>();
  return video->Open(path, live) ? std::move(video) : nullptr;
}

}  // namespace alidade
