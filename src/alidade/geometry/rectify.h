// Rectification: resamples images to an ideal pinhole camera, and stereo pairs to matching rows.
// The maps are computed once; each image then costs one cv::remap.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "alidade/base/api.h"
#include "alidade/geometry/camera.h"
#include "alidade/geometry/raw_camera.h"
#include "alidade/geometry/se3.h"

namespace ALIDADE_API alidade {

// For each pixel of the rectified image, its position in the raw image.
struct RectifyMap {
  cv::Mat coarse, fine;  // CV_16SC2 integer and CV_16UC1 fractional part, the format of cv::remap
  cv::Mat nearest;       // CV_16SC2, rounded to whole pixels

  cv::Mat Apply(const cv::Mat& image) const;  // bilinear; 0 outside the raw image
  // Nearest neighbor, so that depths are not interpolated across depth discontinuities; 0 outside
  // the raw image.
  cv::Mat ApplyNearest(const cv::Mat& depth) const;
};

struct RectifiedCamera {
  Camera camera;  // pinhole without distortion, same size as the raw image
  RectifyMap map;
};

struct RectifiedPair {
  Camera camera;  // of both images, with the baseline; no distortion
  RectifyMap left, right;
  // Rotation from the rectified camera frame to the frame of the left raw camera.
  Eigen::Matrix3d R_left_rectified;
};

// Rectifies one camera to the widest pinhole image without black borders, limited to a field of
// view of `max_fov_degrees` in either direction: close to 180° a pinhole image spends most of its
// pixels on the border.
RectifiedCamera RectifyOne(const RawCamera& raw, double max_fov_degrees = 110);

// Rotates both cameras about their centers until their image planes coincide and rows are parallel
// to the baseline (Fusiello, Trucco & Verri 2000). The rectified optical axis is the mean of both
// axes, made perpendicular to the baseline. Throws Error (input) if the cameras differ in size, the
// right one is not to the right of the left one, or the images have no common part.
RectifiedPair RectifyStereo(const RawCamera& left, const RawCamera& right, const Se3& T_left_right,
                            double max_fov_degrees = 110);

}  // namespace alidade
