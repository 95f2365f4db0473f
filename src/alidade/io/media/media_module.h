// What libalidade_media.so offers: the formats that OpenCV's imgcodecs and videoio know. It is
// loaded by io/files/media.cc when such a file is first met, and linked by nobody. Both sides are
// built together: the interface may hold C++ types, only its two names are C. No exception leaves
// the module.
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>

namespace alidade {

// A video or a live camera.
class MediaStream {
 public:
  virtual ~MediaStream() = default;
  // Frames the container says it has; 0 when it doesn't say.
  virtual int FrameCount() const = 0;
  virtual double FramesPerSecond() const = 0;  // 0 when unknown
  // What the container says of the lens: its focal length in 35 mm equivalents, mm; 0: nothing.
  virtual double FocalLength35() const = 0;
  // On to the next frame; false at the end. Upright: the rotation flag is honoured.
  virtual bool Grab() = 0;
  // Of the frame grabbed last: presentation time (seconds), and its picture (CV_8UC1; empty when
  // undecodable).
  virtual double Time() const = 0;
  virtual cv::Mat Gray() = 0;
  // After Gray(): the same picture, CV_8UC3 blue green red; empty when it has no colours.
  virtual cv::Mat Color() = 0;
  // The next Grab() gives a frame near `time`, as far as the container allows.
  virtual bool SeekNear(double time) = 0;
};

inline constexpr char kMediaModuleFile[] = "libalidade_media.so";

// `use` is an ImageUse. False when it is no image.
using MediaDecodeFunction = bool(const char* bytes, size_t size, int use, cv::Mat* image);
// The same of an image file's EXIF data.
using MediaFocalFunction = double(const char* bytes, size_t size);
// A video file, or with an empty path the live camera `camera`. Null when it cannot be opened.
using MediaOpenFunction = MediaStream*(const char* path, int camera);

}  // namespace alidade
