#include "alidade/io/files/kitti_recording.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/image_file.h"
#include "alidade/io/files/image_list.h"
#include "alidade/io/text.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

using Projection =
    std::array<double, 12>;  // 3x4, row by row; pixels, and metres times pixels in the last column

std::optional<Projection> FindProjection(const std::string& text, const std::string& path,
                                         const std::string& name) {
  for (const TextLine& line : ContentLines(text)) {
    const auto fields = Fields(line.text);
    if (fields[0] != name + ":") continue;
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

Calibration ReadCalibration(const std::string& path, int left_number, cv::Size size) {
  const std::string text = ReadFile(path);
  const std::string left_name = "P" + std::to_string(left_number),
                    right_name = "P" + std::to_string(left_number + 1);
  const auto left = FindProjection(text, path, left_name);
  if (!left) ThrowInput(path + ": `" + left_name + ":` is missing");
  const Projection& P = *left;
  Calibration calibration;
  calibration.origin = path;
  calibration.fps = 10;
  calibration.left = {Lens::kPinhole, size.width, size.height, P[0], P[5], P[2], P[6], {}};
  // The last column's first number is -fx times the camera's place along x.
  if (const auto right = FindProjection(text, path, right_name)) {
    calibration.baseline = P[3] / P[0] - (*right)[3] / (*right)[0];
    if (!(calibration.baseline > 0)) {
      ThrowInput(path + ": " + right_name + " is not to the right of " + left_name);
    }
  }
  return calibration;
}

}  // namespace

bool IsKittiFolder(const std::string& folder) {
  return fs::is_regular_file(folder + "/times.txt") &&
         (fs::is_directory(folder + "/image_0") || fs::is_directory(folder + "/image_2"));
}

Recording ReadKittiRecording(const std::string& folder) {
  const int left = fs::is_directory(folder + "/image_0") ? 0 : 2;
  const std::string left_folder = folder + "/image_" + std::to_string(left);
  const std::string right_folder = folder + "/image_" + std::to_string(left + 1);
  const auto images = ImagesIn(left_folder);
  auto list = ReadStampedList(folder + "/times.txt", StampUnit::kSeconds, false);
  if (images.empty()) ThrowInput(left_folder + " holds no images");
  if (images.size() != list.size()) {
    LogWarning(folder + "/times.txt has " + std::to_string(list.size()) + " times for " +
               std::to_string(images.size()) + " images: only as many frames as there are of both");
    list.resize(std::min(list.size(), images.size()));
  }
  for (size_t i = 0; i < list.size(); ++i) list[i].name = images[i];
  Recording recording;
  recording.kind = "kitti";
  recording.frames = FramesOf(list, left_folder);
  if (fs::is_directory(right_folder)) {
    for (RecordedFrame& frame : recording.frames) {
      const std::string right = right_folder + "/" + fs::path(frame.image).filename().string();
      if (!fs::is_regular_file(right)) continue;
      frame.right = right;
      recording.has_right = true;
    }
  }
  const std::string calibration = folder + "/calib.txt";
  if (fs::is_regular_file(calibration)) {
    recording.calibration = ReadCalibration(calibration, left, SizeOfImages(recording));
  }
  return recording;
}

}  // namespace alidade
