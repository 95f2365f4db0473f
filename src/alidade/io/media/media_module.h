// Interface of libalidade_media.so, which decodes the images of OpenCV's imgcodecs and, by FFmpeg's
// libraries, videos.
// io/files/media.cc loads it on first use; no target links it. The program and the module are built
// together, so the interface may use C++ types; only the function names are C. No exception leaves
// the module.
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>

namespace alidade {

// A video or a live stream.
class MediaStream {
 public:
  virtual ~MediaStream() = default;
  // Number of frames that the container states; 0: not stated.
  virtual int FrameCount() const = 0;
  virtual double FramesPerSecond() const = 0;  // 0 when unknown
  // Focal length of the lens that the container states, mm in 35 mm equivalents; 0: not stated.
  virtual double FocalLength35() const = 0;
  // Grabs the next frame; false at the end. The rotation flag of the video is applied: images are
  // upright.
  virtual bool Grab() = 0;
  // Presentation time (seconds) and image (CV_8UC1; empty when it cannot be decoded) of the frame
  // grabbed last.
  virtual double Time() const = 0;
  virtual cv::Mat Gray() = 0;
  // Call after Gray(): the same image as CV_8UC3, blue green red; empty when the image has no
  // color.
  virtual cv::Mat Color() = 0;
  // The next Grab() returns a frame near `time` (seconds), as precisely as the container allows.
  virtual bool SeekNear(double time) = 0;
  // From any thread: Grab() of a live stream returns false from now on.
  virtual void Interrupt() = 0;
};

enum class PacketCodec { kH264, kH265 };

// A video that comes as packets of one frame each, as byte streams (Annex B of the standards).
class PacketDecoder {
 public:
  virtual ~PacketDecoder() = default;
  enum class Received { kNone, kImage, kDamaged };

  // Decodes the packet with index `number`; false when it is damaged. Then Receive() must be called
  // until it returns kNone.
  virtual bool Send(const char* bytes, size_t size, int64_t number) = 0;
  // No packet follows: the frames kept back so far can be received.
  virtual bool End() = 0;
  // The next frame in order of presentation: the index of its packet, and CV_8UC3, blue green red.
  virtual Received Receive(int64_t& number, cv::Mat& color) = 0;
  // The next packet is a keyframe.
  virtual void Restart() = 0;
};

inline constexpr char kMediaModuleFile[] = "libalidade_media.so";

// `use` is an ImageUse. Returns false when the bytes are not an image.
using MediaDecodeFunction = bool(const char* bytes, size_t size, int use, cv::Mat* image);
// Focal length from EXIF data, mm in 35 mm equivalents; 0: not stated.
using MediaFocalFunction = double(const char* bytes, size_t size);
// Opens a video file or, with `live`, the address of a stream: a stream that sends nothing for
// kLongestSilence is at its end. Null when it cannot be opened.
using MediaOpenFunction = MediaStream*(const char* path, bool live);
inline constexpr double kLongestSilence = 5;  // seconds
// Null when FFmpeg was built without this decoder.
using MediaPacketsFunction = PacketDecoder*(PacketCodec codec);

}  // namespace alidade
