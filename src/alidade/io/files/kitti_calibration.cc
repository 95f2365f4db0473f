#include "alidade/io/files/kitti_calibration.h"

#include <array>
#include <cmath>
#include <optional>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"
#include "alidade/io/text.h"

namespace alidade {
namespace {

// A 3x4 matrix, row-major: pixels; the last column in meters times pixels.
using Projection = std::array<double, 12>;

std::optional<Projection> FindProjection(const std::string& text, const std::string& path,
                                         const std::string& name) {
  for (const TextLine& line : ContentLines(text)) {
    const auto fields = Fields(line.text);
    if (fields.empty() || fields[0] != name + ":") continue;  // a line of commas has no fields
    const std::string where = path + ":" + std::to_string(line.number) + ": ";
    if (fields.size() != 13) ThrowInput(where + name + " needs 12 numbers");
    Projection projection{};
    for (size_t i = 0; i < 12; ++i) {
      const auto number = ParseNumber(fields[i + 1]);
      if (!number || !std::isfinite(*number)) {
        ThrowInput(where + "`" + std::string(fields[i + 1]) + "` is not a finite number");
      }
      projection[i] = *number;
    }
    if (!(projection[0] > 0 && projection[5] > 0))
      ThrowInput(where + "the focal lengths must be positive");
    return projection;
  }
  return std::nullopt;
}

}  // namespace

Calibration ReadKittiCalibration(const std::string& path, int left_number, cv::Size size) {
  return ParseKittiCalibration(ReadFile(path, kMostConfigBytes), path, left_number, size);
}

Calibration ParseKittiCalibration(const std::string& text, const std::string& path, int left_number,
                                  cv::Size size) {
  CheckIsText(text, path);
  const std::string left_name = "P" + std::to_string(left_number),
                    right_name = "P" + std::to_string(left_number + 1);
  const auto left = FindProjection(text, path, left_name);
  if (!left) ThrowInput(path + ": `" + left_name + ":` is missing");
  const Projection& P = *left;
  Calibration calibration;
  calibration.origin = path;
  calibration.left = {Lens::kPinhole, size.width, size.height, P[0], P[5], P[2], P[6], {}};
  // The first number of the last column is -fx times the camera's x position in meters.
  if (const auto right = FindProjection(text, path, right_name)) {
    calibration.baseline = P[3] / P[0] - (*right)[3] / (*right)[0];
    if (!(calibration.baseline > 0)) {
      ThrowInput(path + ": " + right_name + " is not to the right of " + left_name);
    }
  }
  return calibration;
}

}  // namespace alidade
