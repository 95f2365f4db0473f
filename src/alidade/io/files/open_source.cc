#include "alidade/io/files/open_source.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/io/camera/camera_request.h"
#include "alidade/io/camera/camera_source.h"
#include "alidade/io/files/calibration_beside.h"
#include "alidade/io/files/camera_file.h"
#include "alidade/io/files/choose_calibration.h"
#include "alidade/io/files/datasets/euroc_recording.h"
#include "alidade/io/files/datasets/folder_recording.h"
#include "alidade/io/files/datasets/kitti_recording.h"
#include "alidade/io/files/datasets/recording.h"
#include "alidade/io/files/datasets/tum_recording.h"
#include "alidade/io/files/depth_size.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/image_file.h"
#include "alidade/io/files/imu_file.h"
#include "alidade/io/files/media.h"
#include "alidade/io/files/video_source.h"
#include "alidade/io/ros/live/live_source.h"
#include "alidade/io/ros/source/bag_file.h"
#include "alidade/io/ros/source/bag_source.h"
#include "alidade/io/text.h"
#include "alidade/io/wrappers.h"

namespace alidade {
namespace {

// A folder of images in any supported layout; other files in it are ignored.
bool IsKnownFolder(const std::string& path) {
  return IsFolder(path) &&
         (IsTumFolder(path) || IsEurocFolder(path) || IsKittiFolder(path) || IsImageFolder(path));
}

Recording ReadRecording(const std::string& folder, const SourceOptions& options) {
  if (IsTumFolder(folder)) return ReadTumRecording(folder);
  const bool with_imu = !options.imu;
  if (IsEurocFolder(folder)) return ReadEurocRecording(folder, with_imu);
  if (IsKittiFolder(folder)) return ReadKittiRecording(folder);
  if (IsImageFolder(folder)) {
    return ReadFolderRecording(folder);
  }
  if (NamesIn(folder).empty()) ThrowInput(folder + " is an empty folder");
  ThrowInput(folder +
             " is not a recording: known are folders of TUM RGB-D (rgb.txt), EuRoC (mav0/), KITTI "
             "odometry (image_0/ and times.txt), folders of images and ROS recordings (.bag, .db3, "
             ".mcap)");
}

Sensor ChooseSensor(const Recording& recording, const std::string& path,
                    const SourceOptions& options) {
  const Sensor best = recording.has_depth   ? Sensor::kRgbd
                      : recording.has_right ? Sensor::kStereo
                                            : Sensor::kMono;
  const Sensor sensor = options.sensor.value_or(best);
  if (sensor == Sensor::kRgbd && !recording.has_depth) {
    ThrowUsage("--sensor rgbd: " + path + " has no depth images (or a `depth_factor` of 0)");
  }
  if (sensor == Sensor::kStereo && !recording.has_right) {
    ThrowUsage("--sensor stereo: " + path + " has no second camera");
  }
  return sensor;
}

// Focal length from the EXIF data of the first image, mm in 35 mm equivalents; 0: not stated, or
// not needed because a calibration or a field of view is given.
double LensToldBy(const Recording& recording, const SourceOptions& options) {
  if (recording.calibration || options.camera_file || options.fov_degrees ||
      recording.frames.empty())
    return 0;
  try {
    return FocalLength35OfImage(ReadFile(recording.frames.front().image));
  } catch (const Error&) {  // reported when the image is read as a frame
    return 0;
  }
}

// DepthSizeTold() of the first depth images; one of them may be damaged.
std::string DepthSizeOfRecordingTold(const Recording& recording, const std::string& path,
                                     cv::Size size) {
  constexpr int kTries = 5;
  std::string problem;
  int tries = 0;
  for (const RecordedFrame& frame : recording.frames) {
    if (frame.depth.empty()) continue;
    if (tries++ == kTries) break;
    cv::Size depth;
    try {
      depth = ReadImageSize(frame.depth);
    } catch (const Error&) {  // reported when the image is read with its frame
      continue;
    }
    try {
      return DepthSizeTold(depth, size);
    } catch (const Error& error) {
      if (problem.empty()) problem = error.what();
    }
  }
  if (!problem.empty()) ThrowInput(path + ": " + problem);
  return {};
}

// A source and the inertial readings that are part of it, of the camera as mounted.
struct Opened {
  std::unique_ptr<FrameSource> source;
  std::optional<ImuRecording> imu;
};

Opened OpenRecording(const std::string& path, const SourceOptions& options) {
  Recording recording = ReadRecording(path, options);
  recording.name = NameAsTyped(path);
  recording.color = options.color;
  const cv::Size size = SizeOfImages(recording);
  if (!recording.calibration) recording.calibration = CalibrationBeside(path, size, options);
  auto [calibration, guessed, lens_told] =
      ChooseCalibration(recording.calibration, size, options, LensToldBy(recording, options));
  if (recording.kind == "images") {
    recording.fps_assumed = !calibration.fps;
    SetTimes(recording, calibration.fps.value_or(kAssumedFps));
  } else if (!calibration.fps) {
    calibration.fps = RateOf(recording);
  }
  recording.depth_assumed = !calibration.depth_factor;
  if (recording.depth_assumed) calibration.depth_factor = recording.default_depth_factor;
  // A factor of 0 disables depth even when the folder has depth images.
  recording.has_depth = recording.has_depth && *calibration.depth_factor > 0;
  const Sensor sensor = ChooseSensor(recording, path, options);
  if (sensor == Sensor::kStereo && !calibration.right && !(calibration.baseline > 0)) {
    ThrowInput((calibration.origin.empty() ? path : calibration.origin) +
               ": stereo needs the `baseline` or the `right` camera in the camera file (or use "
               "--sensor mono)");
  }
  ImagePreparation preparation(calibration, sensor);
  recording.told = calibration.told;
  if (sensor == Sensor::kRgbd) {
    const std::string told = DepthSizeOfRecordingTold(recording, path, size);
    recording.told += (recording.told.empty() || told.empty() ? "" : "\n") + told;
  }
  recording.lens_told = std::move(lens_told);
  std::optional<ImuRecording> imu = std::move(recording.imu);
  return {PlayRecording(std::move(recording), sensor, std::move(preparation), size, guessed),
          std::move(imu)};
}

// What is known of the inertial sensor by the user's camera file or that of the recording.
std::optional<ImuModel> ImuModelTold(const std::string& path, const SourceOptions& options) {
  std::optional<ImuModel> model;
  if (options.camera_file) model = ReadImuModel(*options.camera_file);
  const std::string beside = path + "/camera.yaml";
  if (!model && IsFile(beside)) model = ReadImuModel(beside);
  return model;
}

// `told` by the source, or what the user's file says instead, of the camera of `info`.
ImuModel ModelFor(ImuModel told, const std::string& path, const SourceOptions& options,
                  const SourceInfo& info) {
  if (std::optional<ImuModel> given = ImuModelTold(path, options)) {
    if (given->rate <= 0) given->rate = told.rate;
    told = *given;
  }
  told.T_camera_imu =
      Se3{info.R_camera_rectified.transpose(), Eigen::Vector3d::Zero()} * told.T_camera_imu;
  return told;
}

// Adds the readings: those of a file, those of the source, or those beside it.
std::unique_ptr<FrameSource> WithReadings(Opened opened, const std::string& path,
                                          const SourceOptions& options) {
  std::string told;
  if (options.imu == kNoImu) return std::move(opened.source);
  if (options.imu) {
    opened.imu = ReadImuFile(*options.imu, &told);
  } else if (!opened.imu) {
    if (const std::string beside = ImuFileBeside(path); !beside.empty()) {
      try {
        opened.imu = ReadImuFile(beside, &told);
      } catch (const Error& error) {
        LogWarning(std::string(error.what()) + "; the inertial readings are left out");
      }
    }
  }
  if (!opened.imu) return std::move(opened.source);
  opened.imu->model = ModelFor(opened.imu->model, path, options, opened.source->Info());
  return WithImu(std::move(opened.source), std::move(*opened.imu), told);
}

std::unique_ptr<FrameSource> OpenTopics(const std::string& path, const SourceOptions& options) {
  if (options.imu && options.imu != kNoImu)
    ThrowUsage("--imu FILE needs a recording; live readings come by a topic (ros2:?imu=TOPIC)");
  std::unique_ptr<TopicSource> source = OpenRos2Source(path, options);
  if (source->ImuTold()) source->UseImu(ModelFor(*source->ImuTold(), "", options, source->Info()));
  return source;
}

}  // namespace

std::unique_ptr<FrameSource> OpenSource(const std::string& path, const SourceOptions& options) {
  if (options.camera_file && options.fov_degrees) ThrowUsage("give either --camera or --fov");
  Opened opened;
  std::unique_ptr<FrameSource>& source = opened.source;
  if (IsCameraSource(path) || IsStreamSource(path)) {
    if (options.imu && options.imu != kNoImu)
      ThrowUsage("--imu FILE needs a recording, not a live camera");
    source =
        IsCameraSource(path) ? OpenCameraSource(path, options) : OpenStreamSource(path, options);
  } else if (IsRos2Source(path)) {
    source = OpenTopics(path, options);
  } else if (IsBagSource(path) && !IsKnownFolder(path)) {
    OpenedBag bag = OpenBagSource(path, options);
    opened = {std::move(bag.source), std::move(bag.imu)};
  } else if (IsFolder(path)) {
    opened = OpenRecording(path, options);
  } else if (!IsThere(path)) {
    ThrowInput("there is no file or folder " + path);
  } else {
    CheckIsFile(path);  // otherwise FFmpeg would wait for a pipe's writer
    source = OpenVideoSource(path, options);
  }
  const bool live = source->Info().live;
  source = Clip(std::move(source), options.first, options.last);
  if (live) return std::move(source);
  return WithReadings(std::move(opened), path, options);
}

}  // namespace alidade
