// Images as an ideal camera would have taken them: fisheye lenses become pinholes, and the two
// images of a stereo pair get rows that match. The maps are made once; each image is then one
// cv::remap.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "alidade/base/api.h"
#include "alidade/geometry/camera.h"
#include "alidade/geometry/raw_camera.h"
#include "alidade/geometry/se3.h"

namespace ALIDADE_API alidade {

// For each pixel of the rectified image the place in the image as taken.
struct RectifyMap {
  cv::Mat coarse, fine;  // CV_16SC2 whole pixels and CV_16UC1 fractions, as cv::remap likes them
  cv::Mat nearest;       // CV_16SC2, rounded

  cv::Mat Apply(const cv::Mat& image) const;  // bilinear; black where nothing was seen
  cv::Mat ApplyNearest(
      const cv::Mat& depth) const;  // no blending across depth steps; 0 where nothing was seen
};

struct RectifiedCamera {
  Camera camera;  // pinhole without distortion, the raw image's size
  RectifyMap map;
};

struct RectifiedPair {
  Camera camera;  // of both images, with the baseline; no distortion
  RectifyMap left, right;
  Eigen::Matrix3d
      R_left_rectified;  // rotation from the rectified camera to the left one as mounted
};

// The widest picture without black borders, but not wider than `max_fov_degrees` either way:
// towards 180° a pinhole spends all its pixels on the rim.
RectifiedCamera RectifyOne(const RawCamera& raw, double max_fov_degrees = 110);

// Both cameras are turned about their centres until their image planes are one plane, with rows
// along the baseline (Fusiello, Trucco & Verri 2000); the turn is shared so that each looks about
// where it looked. Throws Error when the cameras differ in size or the right one isn't to the right
// of the left.
RectifiedPair RectifyStereo(const RawCamera& left, const RawCamera& right, const Se3& T_left_right,
                            double max_fov_degrees = 110);

}  // namespace alidade
