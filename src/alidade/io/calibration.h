// What is known of a recording's cameras, and how its images become those of the `Camera` the
// program works with.
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

struct Calibration {
  RawCamera left;
  std::optional<RawCamera> right;  // of a stereo pair that is not yet rectified
  Se3 T_left_right;                // with `right`
  double baseline = 0;  // metres, of a pair that is rectified already; 0: no second camera
  double fps = 30;      // frames per second
  std::optional<std::array<double, 2>> readout;  // rolling shutter, see Camera; nothing: not said
  std::optional<double> depth_factor;            // depth image value per metre; nothing: not said
  std::string origin;  // file, for errors and warnings; empty: nothing was known
};

// Makes frames from images as taken. Copies share the maps.
class ImagePreparation {
 public:
  // Stereo is rectified unless it is so already, a fisheye becomes a pinhole; a pinhole's
  // radial-tangential distortion otherwise stays in the images and in the camera. Throws Error
  // naming the calibration's origin.
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
