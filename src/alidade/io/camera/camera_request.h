// What a user asks of a live camera: "camera:0?size=1280x720&fps=60&format=MJPEG&exposure=8ms".
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>

namespace alidade {

// How the images of a stereo camera that comes as one device are packed.
enum class StereoLayout { kNone, kSideBySide, kTopBottom };

struct CameraRequest {
  std::string device;              // "/dev/video0"
  cv::Size size;                   // of the device's image, pixels; 0 x 0: chosen
  double fps = 0;                  // images per second; 0: chosen
  std::string format;              // a name of NamesOfPixelFormats(); empty: chosen
  std::optional<double> exposure;  // seconds; nullopt: automatic
  std::optional<int> focus;        // in the driver's units; nullopt: held where it is
  StereoLayout stereo = StereoLayout::kNone;
};

// "camera:N" and "/dev/videoN", with options or without.
bool IsCameraSource(const std::string& source);

// Throws Error (usage) for an unknown option or a value that cannot be.
CameraRequest ParseCameraSource(const std::string& source);

}  // namespace alidade
