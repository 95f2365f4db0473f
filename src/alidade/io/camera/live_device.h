// A device or a network stream that pictures come from as they are taken.
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace alidade {

struct LivePicture {
  cv::Mat image;        // CV_8UC1 or CV_16UC1; empty when it could not be decoded
  cv::Mat color;        // CV_8UC3, where asked for and known
  double time = 0;      // seconds of the system's monotonic clock
  std::string problem;  // why there is no image
};

class LiveDevice {
 public:
  virtual ~LiveDevice() = default;

  enum class Taken {
    kPicture,
    kNothing,  // none came in time
    kGone      // the device was unplugged, or the connection ended: close it
  };
  // The newest picture, waiting for `seconds` at most.
  virtual Taken Take(double seconds, bool color, LivePicture& picture) = 0;

  virtual void Stop() {}  // from any thread: Take() returns soon

  virtual double FramesPerSecond() const = 0;  // 0: unknown
  // For users: "USB Camera, 1280 x 720 MJPEG at 30 per second".
  virtual std::string Told() const = 0;
};

}  // namespace alidade
