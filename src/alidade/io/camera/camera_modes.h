// What a camera can do, and which of it is chosen.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "alidade/io/camera/camera_request.h"
#include "alidade/io/camera/pixel_format.h"

namespace alidade {

struct CameraMode {
  const PixelFormat* format = nullptr;
  cv::Size size;
  double fps = 0;  // images per second; 0: not told
};

// A device that takes pictures.
struct CameraDevice {
  std::string path;                   // "/dev/video0"
  std::string name, bus;              // as its driver tells them
  std::vector<CameraMode> modes;      // with known formats
  std::vector<std::string> others;    // names of formats that are not known
  std::vector<std::string> controls;  // "exposure 0.1 to 500 ms", "focus 0 to 250, automatic"
};

// Among the modes that fulfil the request: the size nearest to VGA, at which SLAM is fast, then a
// rate of 30 per second or more, then the format that costs least to read. With a size asked for:
// exactly that size. With a rate asked for: the rate nearest to it. Null: none fulfils it.
const CameraMode* ChooseMode(const std::vector<CameraMode>& modes, const CameraRequest& request);

std::string NameOf(const CameraMode& mode);  // "1280 x 720 MJPEG at 30 per second", for users

}  // namespace alidade
