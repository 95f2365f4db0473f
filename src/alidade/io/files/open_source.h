// The front door: a recording, video or camera from what the user typed.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "alidade/base/api.h"
#include "alidade/io/frame_source.h"

namespace ALIDADE_API alidade {

struct SourceOptions {
  // Nothing: rgbd when there is depth, stereo when there is a second camera, else mono.
  std::optional<Sensor> sensor = {};
  // Instead of the calibration found beside the images.
  std::optional<std::string> camera_file = {};
  // Horizontal, degrees, 0..180: a plain pinhole instead of any calibration's lens.
  std::optional<double> fov_degrees = {};
  bool fov_rough = false;  // it is only a guess, to begin with: SourceInfo::camera_guessed
  int first = 0;           // frame numbers from 0, both included; the frames keep their numbers
  int last = -1;           // -1: to the end
  bool color = false;      // frames have their colours as well, where there are any
};

// `path` is known by what it holds: a TUM RGB-D folder (rgb.txt), EuRoC (mav0/), KITTI odometry
// (image_0/ times.txt), a folder of images, a video file, a ROS recording (.bag, .db3, .mcap or
// rosbag2's folder; `?image=TOPIC&depth=TOPIC…` behind it chooses), or `camera:N`. Throws Error:
// kInput when it cannot be read or is none of these, kUsage when it has not what the options ask
// for.
std::unique_ptr<FrameSource> OpenSource(const std::string& path, const SourceOptions& options = {});

}  // namespace alidade
