#include "alidade/system/prepare.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "alidade/base/error.h"
#include "alidade/features/color.h"
#include "alidade/features/shrink.h"

namespace alidade {

Camera CameraInUse(Camera camera, const SlamSettings& settings) {
  camera.Check();
  if (settings.sensor != Sensor::kRgbd) camera.depth_factor = 0;
  if (settings.sensor != Sensor::kStereo) camera.baseline = 0;
  if (settings.sensor == Sensor::kRgbd && camera.depth_factor <= 0) {
    ThrowInput("camera: RGB-D needs depth_factor (depth image value per meter)");
  }
  if (settings.sensor == Sensor::kStereo && camera.baseline <= 0) {
    ThrowInput("camera: stereo needs the baseline between the cameras");
  }
  int width = settings.image_width;
  const int longer = std::max(camera.width, camera.height);
  if (width == 0 && settings.max_image_side > 0 && longer > settings.max_image_side) {
    const double scale = static_cast<double>(settings.max_image_side) / longer;
    width = std::max(1, static_cast<int>(std::lround(camera.width * scale)));
  }
  const bool fits = settings.localize ? width != camera.width : width < camera.width;
  return width > 0 && fits ? camera.ScaledToWidth(width) : camera;
}

int WidthAtResolutionOf(const Camera& map, const Camera& camera, int max_side) {
  constexpr double kMostMagnified = 3;
  const double scale = std::sqrt(map.fx * map.fy / (camera.fx * camera.fy));
  const double longer = std::max(camera.width, camera.height);
  const double most = max_side > 0 ? std::max(max_side / longer, 1e-3) : kMostMagnified;
  const double by = std::min({scale, most, kMostMagnified});
  return std::max(1, static_cast<int>(std::lround(camera.width * by)));
}

int FeaturesAsDenseAs(const Camera& map, const Camera& camera, int features) {
  constexpr double kMost = 6;
  const double wider = static_cast<double>(camera.width) * camera.height /
                       (static_cast<double>(map.width) * map.height);
  return static_cast<int>(features * std::clamp(wider, 1.0, kMost));
}

FrameInput Prepare(const FrameInput& input, const Camera& given, const Camera& used,
                   const SlamSettings& settings) {
  const auto check = [&](const cv::Mat& image, const char* what) {
    if (image.cols == given.width && image.rows == given.height) return;
    ThrowInput(std::string(what) + " of " + std::to_string(image.cols) + "x" +
               std::to_string(image.rows) + " pixels, but the camera has " +
               std::to_string(given.width) + "x" + std::to_string(given.height));
  };
  if (!std::isfinite(input.time)) ThrowInput("the frame's time is not a number");
  check(input.image, "image");
  FrameInput prepared = input;
  if (settings.sensor != Sensor::kStereo) prepared.right.release();
  if (settings.sensor != Sensor::kRgbd) prepared.depth.release();
  if (!prepared.right.empty()) check(prepared.right, "right image");
  if (!prepared.depth.empty()) {
    check(prepared.depth, "depth image");
    if (prepared.depth.type() != CV_16U && prepared.depth.type() != CV_32F)
      ThrowInput("depth must be 16-bit or float");
  }
  if (!settings.WantsColor()) {
    prepared.color.release();
  } else if (prepared.color.empty() && prepared.image.channels() >= 3) {
    prepared.color = prepared.image;
  }
  if (!prepared.color.empty()) {
    check(prepared.color, "color image");
    if (prepared.color.depth() != CV_8U ||
        (prepared.color.channels() != 3 && prepared.color.channels() != 4))
      ThrowInput("color images must have three or four channels of 8 bits");
    if (prepared.color.channels() == 4) prepared.color = BgrOf(prepared.color);
    if (used.width != given.width)
      prepared.color = ShrinkArea(prepared.color, {used.width, used.height});
  }
  for (cv::Mat* image : {&prepared.image, &prepared.right}) {
    if (image->empty()) continue;
    if (image->depth() != CV_8U) ThrowInput("images must have 8 bits per channel");
    if (const int n = image->channels(); n != 1 && n != 3 && n != 4)
      ThrowInput("images must have one, three or four channels, not " + std::to_string(n));
    if (image->channels() > 1) *image = GrayOf(*image);
    if (used.width != given.width) *image = ShrinkArea(*image, {used.width, used.height});
  }
  if (!prepared.depth.empty() && used.width != given.width) {
    cv::resize(prepared.depth, prepared.depth, {used.width, used.height}, 0, 0, cv::INTER_NEAREST);
  }
  return prepared;
}

std::shared_ptr<const Picture> PictureOf(const FrameInput& input) {
  return std::make_shared<Picture>(Picture{input.image, input.color, input.depth});
}

std::shared_ptr<const Picture> Copied(const Picture& picture) {
  return std::make_shared<Picture>(Picture{picture.gray.clone(), picture.color.clone(),
                                           picture.depth.clone(), picture.mask.clone()});
}

}  // namespace alidade
