#include "alidade/io/files/open_source.h"

#include <filesystem>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/io/files/camera_file.h"
#include "alidade/io/files/euroc_recording.h"
#include "alidade/io/files/folder_recording.h"
#include "alidade/io/files/kitti_recording.h"
#include "alidade/io/files/recording.h"
#include "alidade/io/files/tum_recording.h"
#include "alidade/io/wrappers.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

Recording ReadRecording(const std::string& folder, const SourceOptions& options) {
  if (IsTumFolder(folder)) return ReadTumRecording(folder);
  if (IsEurocFolder(folder)) return ReadEurocRecording(folder);
  if (IsKittiFolder(folder)) return ReadKittiRecording(folder);
  if (IsImageFolder(folder)) {
    return ReadFolderRecording(folder, options.camera_file
                                           ? std::optional(ReadCameraFile(*options.camera_file).fps)
                                           : std::nullopt);
  }
  if (fs::is_empty(folder)) ThrowInput(folder + " is an empty folder");
  ThrowInput(folder +
             " is no recording: known are TUM RGB-D folders (rgb.txt), EuRoC (mav0/), KITTI "
             "odometry (image_0/ and "
             "times.txt) and folders of images");
}

Sensor ChooseSensor(const Recording& recording, const std::string& path,
                    const SourceOptions& options) {
  const Sensor best = recording.has_depth   ? Sensor::kRgbd
                      : recording.has_right ? Sensor::kStereo
                                            : Sensor::kMono;
  const Sensor sensor = options.sensor.value_or(best);
  if (sensor == Sensor::kRgbd && !recording.has_depth)
    ThrowUsage("--sensor rgbd: " + path + " has no depth images");
  if (sensor == Sensor::kStereo && !recording.has_right)
    ThrowUsage("--sensor stereo: " + path + " has no second camera");
  return sensor;
}

struct ChosenCalibration {
  Calibration calibration;
  bool guessed = false;
};

ChosenCalibration ChooseCalibration(const Recording& recording, cv::Size size,
                                    const SourceOptions& options) {
  std::optional<Calibration> found = recording.calibration;
  if (options.camera_file) found = ReadCameraFile(*options.camera_file);
  if (found && !options.fov_degrees) return {*found, false};
  ChosenCalibration chosen;
  chosen.calibration =
      GuessedCalibration(size.width, size.height, options.fov_degrees.value_or(kDefaultFovDegrees));
  if (found) {  // what a field of view says nothing about
    chosen.calibration.baseline = found->baseline;
    chosen.calibration.fps = found->fps;
    chosen.calibration.depth_factor = found->depth_factor;
  }
  chosen.guessed = !options.fov_degrees;
  if (chosen.guessed) {
    LogWarning(
        "no camera file: a horizontal field of view of 66 degrees is assumed (--fov or --camera "
        "say better)");
  }
  return chosen;
}

void CheckSizes(const Calibration& calibration, cv::Size size) {
  if (size != cv::Size(calibration.left.width, calibration.left.height)) {
    ThrowInput(calibration.origin + " is for images of " + std::to_string(calibration.left.width) +
               "x" + std::to_string(calibration.left.height) + ", the recording's are " +
               std::to_string(size.width) + "x" + std::to_string(size.height));
  }
}

std::unique_ptr<FrameSource> OpenRecording(const std::string& path, const SourceOptions& options) {
  Recording recording = ReadRecording(path, options);
  recording.name = fs::weakly_canonical(path).filename().string();
  const Sensor sensor = ChooseSensor(recording, path, options);
  const cv::Size size = SizeOfImages(recording);
  auto [calibration, guessed] = ChooseCalibration(recording, size, options);
  CheckSizes(calibration, size);
  if (!calibration.depth_factor) calibration.depth_factor = recording.default_depth_factor;
  if (sensor == Sensor::kRgbd && !(*calibration.depth_factor > 0)) {
    ThrowInput((calibration.origin.empty() ? path : calibration.origin) +
               ": depth images need a `depth_factor` above 0 in the camera file");
  }
  if (sensor == Sensor::kStereo && !calibration.right && !(calibration.baseline > 0)) {
    ThrowInput((calibration.origin.empty() ? path : calibration.origin) +
               ": stereo needs the `baseline` or the `right` camera in the camera file (or ask for "
               "--sensor mono)");
  }
  ImagePreparation preparation(calibration, sensor);
  return PlayRecording(std::move(recording), sensor, std::move(preparation), size, guessed);
}

}  // namespace

std::unique_ptr<FrameSource> OpenSource(const std::string& path, const SourceOptions& options) {
  if (options.camera_file && options.fov_degrees) ThrowUsage("give --camera or --fov, not both");
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) ThrowInput("there is no file or folder " + path);
  if (!fs::is_directory(status)) ThrowInput(path + " is not a folder");
  return Clip(OpenRecording(path, options), options.first, options.last);
}

}  // namespace alidade
