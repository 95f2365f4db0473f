// Opens a recording, a video or a live camera from the path or name the user gives.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "alidade/base/api.h"
#include "alidade/io/frame_source.h"

namespace ALIDADE_API alidade {

// SourceOptions::imu: no inertial readings.
inline constexpr char kNoImu[] = "off";

struct SourceOptions {
  // nullopt: kRgbd when the source has depth, kStereo when it has a second camera, otherwise kMono.
  std::optional<Sensor> sensor = {};
  // Used instead of the calibration found beside the images.
  std::optional<std::string> camera_file = {};
  // Horizontal, degrees, 0..180: a pinhole without distortion, used instead of any calibration.
  std::optional<double> fov_degrees = {};
  bool fov_rough = false;  // `fov_degrees` is only approximate; sets SourceInfo::camera_guessed
  int first = 0;           // first frame, counted from 0; frames keep their numbers
  int last = -1;           // last frame, included; -1: to the end
  // The inertial readings: a file of them, or kNoImu. nullopt: those that the source brings.
  std::optional<std::string> imu = {};
  bool color = false;  // read the frames' colors as well, if there are any
  // Topics of ROS: the robot's frame, whose transform to the camera /tf_static may have.
  std::string base_frame = {};
  // While a live source waits for its first images: true ends the wait. Null: it waits on.
  bool (*interrupted)() = nullptr;
};

// The kind of source is detected from its content: a TUM RGB-D folder (rgb.txt), EuRoC (mav0/),
// KITTI odometry (image_0/ times.txt), a folder of images, a video file, a ROS recording (.bag,
// .db3, .mcap or the folder of a rosbag2; `?image=TOPIC&depth=TOPIC…` after the path selects
// topics), `ros2:` (topics as they are published, with the same options), a live camera
// (`camera:N` or /dev/videoN, `?size=WxH&fps=N&format=NAME&exposure=TIME&focus=N&stereo=LAYOUT`
// after it) or the address of a stream (rtsp://, http://, …). Throws Error: kInput when the source
// cannot be read or recognized, kUsage when it lacks what the options require.
std::unique_ptr<FrameSource> OpenSource(const std::string& path, const SourceOptions& options = {});

}  // namespace alidade
