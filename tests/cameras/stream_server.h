// Cameras of the network, for tests: a server of RTSP (MPEG-4, by FFmpeg's encoder and packets of
// RTP over TCP) and one of HTTP (a stream of JPEG images), on loopback.
#pragma once

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string>
#include <thread>

#include "alidade/io/files/image_codec.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

namespace alidade {

// Image `i` of the stream: a bright square that moves to the right, 4 pixels each.
inline cv::Mat StreamPicture(int i) {
  cv::Mat image(120, 160, CV_8UC1, cv::Scalar(40));
  cv::rectangle(image, {4 * (i % 30), 40, 30, 30}, 220, cv::FILLED);
  return image;
}
inline constexpr int kStreamFps = 25;

// Listens on a port of the system's choice and serves one client after the other.
class StreamServer {
 public:
  // `port`: 0, or that of an earlier server.
  explicit StreamServer(bool rtsp, uint16_t port = 0) : rtsp_(rtsp) {
    listener_ = socket(AF_INET, SOCK_STREAM, 0);
    const int yes = 1;
    setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(port);
    if (bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) abort();
    listen(listener_, 4);
    socklen_t size = sizeof address;
    getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { Serve(); });
  }
  ~StreamServer() {  // as a cut: the connection is closed without a word
    ends_ = true;
    shutdown(listener_, SHUT_RDWR);
    if (client_ >= 0) shutdown(client_, SHUT_RDWR);
    thread_.join();
    close(listener_);
  }
  StreamServer(const StreamServer&) = delete;
  StreamServer& operator=(const StreamServer&) = delete;

  uint16_t port() const { return port_; }
  std::string address() const {
    return (rtsp_ ? "rtsp://user:secret@127.0.0.1:" : "http://127.0.0.1:") + std::to_string(port_) +
           "/camera";
  }
  void Silence() { silent_ = true; }  // sends nothing more, and leaves the connection open

 private:
  void Serve() {
    while (!ends_) {
      const int client = accept(listener_, nullptr, nullptr);
      if (client < 0) return;
      client_ = client;
      rtsp_ ? ServeRtsp() : ServeHttp();
      client_ = -1;
      close(client);
    }
  }

  bool Send(const std::string& bytes) const {
    return send(client_, bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
           static_cast<ssize_t>(bytes.size());
  }

  // A request without a body; empty: the connection ended.
  std::string Request() const {
    std::string text;
    char c = 0;
    while (text.find("\r\n\r\n") == std::string::npos) {
      if (recv(client_, &c, 1, 0) != 1) return {};
      text += c;
    }
    return text;
  }

  // Calls `send(i)` at the stream's rate until it returns false.
  template <typename Function>
  void Play(const Function& send_image) {
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; !ends_ && !silent_; ++i) {
      std::this_thread::sleep_until(begin + i * std::chrono::microseconds(1000000 / kStreamFps));
      if (!send_image(i)) return;
    }
    while (!ends_) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }

  void ServeHttp() {
    if (Request().empty()) return;
    if (!Send("HTTP/1.1 200 OK\r\nContent-Type: multipart/x-mixed-replace; boundary=cut\r\n\r\n"))
      return;
    Play([&](int i) {
      const std::string jpeg = EncodeJpeg(StreamPicture(i), 90);
      return Send("--cut\r\nContent-Type: image/jpeg\r\nContent-Length: " +
                  std::to_string(jpeg.size()) + "\r\n\r\n" + jpeg + "\r\n");
    });
  }

  void ServeRtsp() {
    // The encoder and the maker of packets, which end with the connection.
    const AVCodec* codec = avcodec_find_encoder(AV_CODEC_ID_MPEG4);
    AVCodecContext* encoder = avcodec_alloc_context3(codec);
    encoder->width = 160;
    encoder->height = 120;
    encoder->pix_fmt = AV_PIX_FMT_YUV420P;
    encoder->time_base = {1, kStreamFps};
    encoder->gop_size = 5;
    encoder->bit_rate = 2000000;
    encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    avcodec_open2(encoder, codec, nullptr);
    AVFormatContext* packets = nullptr;
    avformat_alloc_output_context2(&packets, nullptr, "rtp", nullptr);
    AVStream* stream = avformat_new_stream(packets, nullptr);
    avcodec_parameters_from_context(stream->codecpar, encoder);
    stream->time_base = encoder->time_base;
    constexpr int kMostBytes = 1400;
    packets->pb = avio_alloc_context(
        static_cast<unsigned char*>(av_malloc(kMostBytes)), kMostBytes, 1, this, nullptr,
        [](void* server, uint8_t* bytes, int size) {
          std::string framed = {'$', bytes[1] >= 192 && bytes[1] <= 223 ? '\1' : '\0',
                                static_cast<char>(size >> 8), static_cast<char>(size)};
          framed.append(reinterpret_cast<char*>(bytes), static_cast<size_t>(size));
          return static_cast<StreamServer*>(server)->Send(framed) ? size : AVERROR(EIO);
        },
        nullptr);
    packets->pb->max_packet_size = packets->packet_size = kMostBytes;
    if (Negotiate(packets) && avformat_write_header(packets, nullptr) >= 0) {
      Play([&](int i) { return SendImage(encoder, packets, i); });
    }
    av_freep(&packets->pb->buffer);
    avio_context_free(&packets->pb);
    avformat_free_context(packets);
    avcodec_free_context(&encoder);
  }

  // Until the client has asked to play.
  bool Negotiate(AVFormatContext* packets) {
    char description[2000];
    av_sdp_create(&packets, 1, description, sizeof description);
    while (true) {
      const std::string request = Request();
      if (request.empty()) return false;
      const size_t number = request.find("CSeq:");
      std::string answer = "RTSP/1.0 200 OK\r\n" +
                           request.substr(number, request.find("\r\n", number) - number) +
                           "\r\nSession: 1\r\n";
      if (request.compare(0, 8, "DESCRIBE") == 0) {
        answer += "Content-Type: application/sdp\r\nContent-Length: " +
                  std::to_string(std::string(description).size()) + "\r\n\r\n" + description;
      } else if (request.compare(0, 5, "SETUP") == 0) {
        answer += "Transport: RTP/AVP/TCP;unicast;interleaved=0-1\r\n\r\n";
      } else {
        answer += "Public: DESCRIBE, SETUP, PLAY, TEARDOWN\r\n\r\n";
      }
      if (!Send(answer)) return false;
      if (request.compare(0, 4, "PLAY") == 0) return true;
    }
  }

  static bool SendImage(AVCodecContext* encoder, AVFormatContext* packets, int i) {
    AVFrame* frame = av_frame_alloc();
    frame->format = encoder->pix_fmt;
    frame->width = encoder->width;
    frame->height = encoder->height;
    av_frame_get_buffer(frame, 0);
    const cv::Mat image = StreamPicture(i);
    for (int y = 0; y < image.rows; ++y)
      std::copy_n(image.ptr(y), image.cols, frame->data[0] + y * frame->linesize[0]);
    for (const int plane : {1, 2})
      std::fill_n(frame->data[plane], frame->linesize[plane] * image.rows / 2, uint8_t{128});
    frame->pts = i;
    avcodec_send_frame(encoder, frame);
    av_frame_free(&frame);
    AVPacket* packet = av_packet_alloc();
    bool sent = true;
    while (sent && avcodec_receive_packet(encoder, packet) == 0) {
      av_packet_rescale_ts(packet, encoder->time_base, packets->streams[0]->time_base);
      sent = av_write_frame(packets, packet) >= 0;
      av_packet_unref(packet);
    }
    av_packet_free(&packet);
    return sent;
  }

  const bool rtsp_;
  int listener_ = -1;
  uint16_t port_ = 0;
  std::atomic<int> client_{-1};
  std::atomic<bool> ends_{false}, silent_{false};
  std::thread thread_;
};

}  // namespace alidade
