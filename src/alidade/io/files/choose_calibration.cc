#include "alidade/io/files/choose_calibration.h"

#include <cmath>
#include <numbers>
#include <string>

#include "alidade/base/error.h"
#include "alidade/base/print.h"
#include "alidade/io/files/camera_file.h"

namespace alidade {
namespace {

constexpr double kShortest35 = 6, kLongest35 = 1000;  // mm

void CheckSize(const Calibration& calibration, cv::Size size) {
  if (size != cv::Size(calibration.left.width, calibration.left.height)) {
    ThrowInput(calibration.origin + " is for images of " + std::to_string(calibration.left.width) +
               "x" + std::to_string(calibration.left.height) +
               ", but those of the recording have " + std::to_string(size.width) + "x" +
               std::to_string(size.height));
  }
}

}  // namespace

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
  if (options.camera_file) found = ReadCameraFile(*options.camera_file);
  if (found && !options.fov_degrees) {
    CheckSize(*found, size);
    return {*found, false, {}};
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
