// Calibration of a recording's cameras, and the conversion of its images into those of the `Camera`
// that SLAM uses.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "alidade/base/api.h"
#include "alidade/geometry/camera.h"
#include "alidade/geometry/raw_camera.h"
#include "alidade/geometry/rectify.h"
#include "alidade/geometry/se3.h"
#include "alidade/io/frame_source.h"

namespace ALIDADE_API alidade {

// Frames per second where nothing states them.
inline constexpr double kAssumedFps = 30;

struct Calibration {
  RawCamera left;
  std::optional<RawCamera> right;  // second camera of an unrectified stereo pair
  Se3 T_left_right;           // pose of the right camera in the left one, meters; used with `right`
  double baseline = 0;        // meters, of an already rectified pair; 0: no second camera
  std::optional<double> fps;  // frames per second; nullopt: not stated
  // Rolling shutter readout, see Camera; nullopt: not stated.
  std::optional<std::array<double, 2>> readout;
  std::optional<double> depth_factor;  // depth image value per meter; nullopt: not stated
  // Sentences for the user, one a line: what was approximated or scaled; empty: nothing.
  std::string told;
  std::string origin;  // file, for errors and warnings; empty: no calibration was found
};

// Converts images as recorded into the images SLAM uses. Copies share the rectification maps.
class ImagePreparation {
 public:
  // Rectifies a stereo pair unless it is already rectified, and maps a fisheye image to a pinhole
  // image. The radial-tangential distortion of a pinhole camera stays in the image and in the
  // camera model, except for stereo. Throws Error naming the calibration's origin when a size or a
  // parameter is out of range.
  ImagePreparation(const Calibration& calibration, Sensor sensor);

  const Camera& camera() const { return camera_; }
  const Eigen::Matrix3d& R_camera_rectified() const { return R_camera_rectified_; }

  cv::Mat Left(const cv::Mat& image) const { return left_ ? left_->Apply(image) : image; }
  cv::Mat Right(const cv::Mat& image) const { return right_ ? right_->Apply(image) : image; }
  cv::Mat Depth(const cv::Mat& depth) const { return left_ ? left_->ApplyNearest(depth) : depth; }

 private:
  Camera camera_;
  Eigen::Matrix3d R_camera_rectified_ = Eigen::Matrix3d::Identity();
  std::optional<RectifyMap> left_, right_;
};

}  // namespace alidade
