// Where frames come from: a recording on disk, a camera, a rendered scene.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/geometry/camera.h"
#include "alidade/inertial/imu.h"

namespace ALIDADE_API alidade {

enum class Sensor { kMono, kStereo, kRgbd };

// The name used on the command line, in stats.json and in saved maps.
inline const char* NameOf(Sensor sensor) {
  return sensor == Sensor::kMono ? "mono" : sensor == Sensor::kStereo ? "stereo" : "rgbd";
}

struct SourceFrame {
  double time = 0;    // seconds
  std::string stamp;  // time as written in the recording, for output files that keep it verbatim
  int number = 0;     // index in the recording, from 0; skipped frames keep their number
  cv::Mat image;      // 8-bit gray, rectified where the source rectifies
  cv::Mat right;      // stereo only; empty when missing for this frame
  // Counts the recordings that were joined into this one. A frame of another part than the one
  // before does not continue it (Slam::Reset()), and its time may be earlier.
  int part = 0;
  // RGB-D only: CV_16U as stored or CV_32F in meters; empty when missing for this frame.
  cv::Mat depth;
  // `image` in color (CV_8UC3, blue green red), when color was requested and the recording has it.
  cv::Mat color = {};
  // Why this frame could not be read; its images are empty then. The consumer warns and counts.
  // Empty: no problem.
  std::string problem;
  // Why `right` or `depth` could not be read; the frame is still of use as that of one camera. The
  // consumer warns. Empty: no problem.
  std::string incomplete = {};
  // True pose in the scene's world frame; set by rendered recordings only.
  std::optional<Se3> T_world_camera = {};
  // True depth of each pixel of `image`: CV_32F, meters along z, 0 = no surface. Rendered
  // recordings only.
  cv::Mat true_depth = {};
  // Readings of the inertial sensor since those of the last frame, at least up to this image's time
  // where there are any, in order of time; see FrameInput::imu.
  std::vector<ImuSample> imu = {};
};

struct SourceInfo {
  std::string name;  // short, usable in a file name
  // "tum", "euroc", "kitti", "images", "video", "ros", "synth", "camera", "ros2".
  std::string kind;
  bool live = false;  // images come as they are taken: a camera, topics
  Sensor sensor = Sensor::kMono;
  Camera camera;                // after any rectification
  bool camera_guessed = false;  // no calibration: the field of view is assumed
  bool depth_assumed = false;   // the camera's depth_factor is that of the format
  bool fps_assumed = false;     // nothing tells the times of the images
  // The recording's own description of its lens, when the assumed field of view comes from it ("26
  // mm in 35 mm equivalents"); otherwise empty.
  std::string lens_told;
  // Which of the recording's streams were chosen, as a message for users; empty when there was no
  // choice.
  std::string told;
  // Rotation from the rectified camera's frame to the frame of the camera as mounted, in which
  // trajectories are given.
  Eigen::Matrix3d R_camera_rectified = Eigen::Matrix3d::Identity();
  // The inertial sensor whose readings come with the frames; nullopt: none. T_camera_imu is of
  // `camera`, after any rectification.
  std::optional<ImuModel> imu;
  std::string frame_id;  // of the images, where messages of ROS tell it; otherwise empty
  // The (left) camera as mounted, in the frame SourceOptions::base_frame; nullopt: not told.
  std::optional<Se3> T_base_camera;
  int frames = -1;  // -1 when unknown (a live camera, some videos)
};

class FrameSource {
 public:
  virtual ~FrameSource() = default;
  virtual const SourceInfo& Info() const = 0;
  // Returns the next frame, or nullopt at the end. Not thread-safe.
  virtual std::optional<SourceFrame> Next() = 0;
  // Makes the frame with index `frames` (from 0) the next one. Returns false when the source cannot
  // seek (a live camera).
  virtual bool Seek(int frames) {
    (void)frames;
    return false;
  }
  // From any thread: Next() waits for no further image of a live source, and returns nullopt.
  virtual void Stop() {}
};

}  // namespace alidade
