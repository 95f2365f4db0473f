#include "alidade/io/files/choose_calibration.h"

#include <cmath>
#include <numbers>
#include <string>

#include "alidade/base/error.h"
#include "alidade/base/print.h"
#include "alidade/io/files/camera_file.h"
#include "alidade/io/files/depth_size.h"

namespace alidade {
namespace {

constexpr double kShortest35 = 6, kLongest35 = 1000;  // mm

void Scale(RawCamera& camera, cv::Size size) {
  const double x = static_cast<double>(size.width) / camera.width;
  const double y = static_cast<double>(size.height) / camera.height;
  camera.width = size.width;
  camera.height = size.height;
  camera.fx *= x;
  camera.fy *= y;
  // Pixel centers are at integers, image borders at ±0.5.
  camera.cx = (camera.cx + 0.5) * x - 0.5;
  camera.cy = (camera.cy + 0.5) * y - 0.5;
}

// Equal up to the rounding of one side to whole pixels.
bool SameAspect(const RawCamera& camera, cv::Size size) {
  const double width = static_cast<double>(camera.width) * size.height / camera.height;
  const double height = static_cast<double>(camera.height) * size.width / camera.width;
  return std::abs(width - size.width) < 1 || std::abs(height - size.height) < 1;
}

}  // namespace

Calibration FitToSize(Calibration calibration, cv::Size size, bool with_right) {
  RawCamera& left = calibration.left;
  const auto tell = [&](const std::string& sentence) {
    calibration.told += (calibration.told.empty() ? "" : "\n") + sentence;
  };
  const std::string was = SizeText({left.width, left.height}), now = SizeText(size);
  if (left.width == 0) {
    tell(calibration.origin +
         " does not state the size of its images; taken as that of the "
         "recording, " +
         now);
    for (RawCamera* camera : {&left, calibration.right ? &*calibration.right : nullptr}) {
      if (!camera) continue;
      camera->width = size.width;
      camera->height = size.height;
    }
  } else if (size != cv::Size(left.width, left.height)) {
    if (!SameAspect(left, size)) {
      ThrowInput(calibration.origin + " is for images of " + was +
                 ", but those of the recording have " + now +
                 ", another aspect ratio: calibrate at this size, or give the calibration of the "
                 "cropped images");
    }
    tell(calibration.origin + ", for images of " + was + ", is scaled to " + now +
         "; if these are a crop and not scaled, calibrate at this size");
    if (calibration.right) {
      if (calibration.right->width == left.width && calibration.right->height == left.height)
        Scale(*calibration.right, size);
    }
    Scale(left, size);
  }
  RefuseFolds(calibration, with_right);
  return calibration;
}

double AssumedFov(cv::Size size) {
  if (size.width >= size.height) return kDefaultFovDegrees;
  const double degree = std::numbers::pi / 180;
  const double half = std::tan(kDefaultFovDegrees / 2 * degree) * size.width / size.height;
  return 2 / degree * std::atan(half);
}

double FovOfFocalLength35(double millimetres, cv::Size size) {
  constexpr double kDiagonal35 = 43.266615;  // mm, the diagonal of a 36 x 24 frame
  const double focal = millimetres / kDiagonal35 * std::hypot(size.width, size.height);
  return 360 / std::numbers::pi * std::atan(size.width / (2 * focal));
}

ChosenCalibration ChooseCalibration(const std::optional<Calibration>& beside, cv::Size size,
                                    const SourceOptions& options, double focal_length_35) {
  std::optional<Calibration> found = beside;
  if (options.camera_file) {
    found = ReadCameraFile(*options.camera_file, size);
    if (!found->fps && beside) found->fps = beside->fps;
  }
  if (found && !options.fov_degrees) {
    return {FitToSize(*found, size, options.sensor != Sensor::kMono), false, {}};
  }
  ChosenCalibration chosen;
  double assumed = AssumedFov(size);
  // Values outside the range from fisheye to telephoto lenses are not focal lengths.
  if (!options.fov_degrees && focal_length_35 >= kShortest35 && focal_length_35 <= kLongest35) {
    assumed = FovOfFocalLength35(focal_length_35, size);
    char text[60];
    PrintTo(text, sizeof(text), "%g mm in 35 mm equivalents", focal_length_35);
    chosen.lens_told = text;
  }
  chosen.calibration =
      GuessedCalibration(size.width, size.height, options.fov_degrees.value_or(assumed));
  if (found) {  // properties that do not depend on the field of view
    chosen.calibration.baseline = found->baseline;
    chosen.calibration.fps = found->fps;
    chosen.calibration.depth_factor = found->depth_factor;
  }
  chosen.guessed = !options.fov_degrees || options.fov_rough;
  return chosen;
}

}  // namespace alidade
