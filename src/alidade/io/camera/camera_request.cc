#include "alidade/io/camera/camera_request.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "alidade/base/error.h"
#include "alidade/geometry/picture_size.h"
#include "alidade/io/camera/pixel_format.h"
#include "alidade/io/text.h"

namespace alidade {
namespace {

constexpr std::string_view kCamera = "camera:", kVideo = "/dev/video";

bool StartsWith(std::string_view text, std::string_view start) {
  return text.substr(0, start.size()) == start;
}

bool IsNumber(std::string_view text) {
  return !text.empty() && text.size() < 4 &&
         text.find_first_not_of("0123456789") == std::string_view::npos;
}

[[noreturn]] void Refuse(std::string_view option, const char* wanted) {
  ThrowUsage("camera option '" + std::string(option) + "': " + wanted);
}

double NumberIn(std::string_view option, std::string_view value, double most, const char* wanted) {
  const std::optional<double> number = ParseNumber(value);
  if (!number || !(*number > 0) || !(*number <= most)) Refuse(option, wanted);
  return *number;
}

cv::Size SizeIn(std::string_view option, std::string_view value) {
  const char* wanted = "size is WIDTHxHEIGHT in pixels, as size=1280x720";
  const size_t x = value.find('x');
  if (x == std::string_view::npos) Refuse(option, wanted);
  const double width = NumberIn(option, value.substr(0, x), kMostSide, wanted);
  const double height = NumberIn(option, value.substr(x + 1), kMostSide, wanted);
  if (width != std::floor(width) || height != std::floor(height)) Refuse(option, wanted);
  return {static_cast<int>(width), static_cast<int>(height)};
}

// Seconds.
double ExposureIn(std::string_view option, std::string_view value) {
  const char* wanted = "exposure is a time, as exposure=8ms or exposure=500us";
  double unit = 0;
  for (const auto& [name, seconds] :
       {std::pair{"us", 1e-6}, std::pair{"ms", 1e-3}, std::pair{"s", 1.0}}) {
    const std::string_view end = name;
    if (unit > 0 || value.size() <= end.size() || value.substr(value.size() - end.size()) != end)
      continue;
    unit = seconds;
    value.remove_suffix(end.size());
  }
  if (unit == 0) Refuse(option, wanted);
  return unit * NumberIn(option, value, 10 / unit, wanted);
}

StereoLayout StereoIn(std::string_view option, std::string_view value) {
  if (value == "side-by-side") return StereoLayout::kSideBySide;
  if (value == "top-bottom") return StereoLayout::kTopBottom;
  Refuse(option, "stereo is side-by-side (the left camera's half is left) or top-bottom");
}

std::string FormatIn(std::string_view option, std::string_view value) {
  std::string upper(value);
  std::transform(upper.begin(), upper.end(), upper.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c; });
  if (FindPixelFormat(upper) == nullptr)
    Refuse(option, ("formats are " + NamesOfPixelFormats()).c_str());
  return upper;
}

void TakeOption(std::string_view option, CameraRequest& request) {
  const size_t equals = option.find('=');
  const std::string_view name = option.substr(0, equals);
  const std::string_view value =
      equals == std::string_view::npos ? std::string_view() : option.substr(equals + 1);
  if (name == "size") {
    request.size = SizeIn(option, value);
  } else if (name == "fps") {
    request.fps = NumberIn(option, value, 1000, "fps is a number of images per second, as fps=60");
  } else if (name == "format") {
    request.format = FormatIn(option, value);
  } else if (name == "exposure") {
    if (value != "auto") request.exposure = ExposureIn(option, value);
  } else if (name == "focus") {
    const std::optional<double> focus = ParseNumber(value);
    if (!focus || *focus != std::floor(*focus) || !(std::abs(*focus) < 1e9))
      Refuse(option,
             "focus is a whole number in the driver's units (`alidade cameras` tells them)");
    request.focus = static_cast<int>(*focus);
  } else if (name == "stereo") {
    request.stereo = StereoIn(option, value);
  } else {
    Refuse(option, "known are size, fps, format, exposure, focus and stereo");
  }
}

}  // namespace

bool IsCameraSource(const std::string& source) {
  return StartsWith(source, kCamera) || StartsWith(source, kVideo);
}

CameraRequest ParseCameraSource(const std::string& source) {
  const std::string_view text = source;
  const size_t question = std::min(text.find('?'), text.size());
  const std::string_view name = text.substr(0, question);
  const std::string_view number =
      name.substr(StartsWith(name, kCamera) ? kCamera.size() : kVideo.size());
  if (!IsNumber(number))
    ThrowUsage("live cameras are camera:0, camera:1, … or /dev/video0, …, not " +
               std::string(name) + "; `alidade cameras` lists them");
  CameraRequest request;
  request.device = std::string(kVideo) + std::string(number);
  std::string_view options = text.substr(std::min(question + 1, text.size()));
  while (!options.empty()) {
    const size_t end = std::min(options.find('&'), options.size());
    TakeOption(options.substr(0, end), request);
    options.remove_prefix(std::min(end + 1, options.size()));
  }
  return request;
}

}  // namespace alidade
