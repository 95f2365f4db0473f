// Where frames come from: a recording on disk, a camera, a rendered scene.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "alidade/base/api.h"
#include "alidade/geometry/camera.h"

namespace ALIDADE_API alidade {

enum class Sensor { kMono, kStereo, kRgbd };

// As on the command line, in stats.json and in saved maps.
inline const char* NameOf(Sensor sensor) {
  return sensor == Sensor::kMono ? "mono" : sensor == Sensor::kStereo ? "stereo" : "rgbd";
}

struct SourceFrame {
  double time = 0;    // seconds
  std::string stamp;  // as written in the recording, for files that must keep it verbatim
  int number = 0;     // index in the recording, from 0 (skipped frames keep their number)
  cv::Mat image;      // 8 bit grey, rectified where the source rectifies
  cv::Mat right;      // stereo only; empty when missing for this frame
  cv::Mat
      depth;  // RGB-D only: CV_16U as stored or CV_32F in metres; empty when missing for this frame
  // `image` in colour (CV_8UC3, blue green red), when it was asked for and there is any.
  cv::Mat color = {};
  // Not empty: this frame could not be read and why; images are empty. Whoever takes the frames
  // warns and counts.
  std::string problem;
  // Where the camera truly was, in some world: rendered recordings know.
  std::optional<Se3> T_world_camera = {};
  // And the exact depth of each pixel of `image`: CV_32F, metres along z, 0 = nothing there.
  cv::Mat true_depth = {};
};

struct SourceInfo {
  std::string name;  // short, usable in a file name
  std::string kind;  // "tum", "euroc", "kitti", "images", "video", "ros", "synth",
                     // "camera"
  Sensor sensor = Sensor::kMono;
  Camera camera;                // after any rectification
  bool camera_guessed = false;  // nothing certain was known: field of view assumed
  // What the recording itself says of its lens, in words, where the field of view that is assumed
  // is by that ("26 mm in 35 mm equivalents"); else empty.
  std::string lens_told;
  // What was chosen of what the recording has, for people; empty where there was nothing to choose.
  std::string told;
  // Rotation from the rectified camera's frame to that of the camera as mounted: trajectories are
  // the latter's.
  Eigen::Matrix3d R_camera_rectified = Eigen::Matrix3d::Identity();
  int frames = -1;  // -1 when unknown (camera; some videos)
};

class FrameSource {
 public:
  virtual ~FrameSource() = default;
  virtual const SourceInfo& Info() const = 0;
  // The next frame, nullopt at the end. Not thread-safe.
  virtual std::optional<SourceFrame> Next() = 0;
  // The next frame will be the one `frames` after the first. False where that cannot be done (a
  // live camera).
  virtual bool Seek(int frames) {
    (void)frames;
    return false;
  }
};

}  // namespace alidade
