#include "alidade/geometry/rectify.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <string>

#include "alidade/base/error.h"

namespace alidade {
namespace {

// Rectangle on the plane z = 1 of the rectified frame.
struct PlaneRect {
  double left, right, top, bottom;
};

// The largest axis-aligned rectangle around the optical axis that the raw image covers, found along
// the raw image's borders.
PlaneRect CoveredRect(const RawCamera& raw, const Eigen::Matrix3d& R_raw_rectified, double limit) {
  PlaneRect rect{-limit, limit, -limit, limit};
  constexpr int kSteps = 64;
  const auto on_plane = [&](double x, double y) {
    const Eigen::Vector3d p = R_raw_rectified.transpose() * raw.Direction({x, y});
    // A direction behind or parallel to the plane is mapped so far out that it does not limit the
    // rectangle.
    const double z = std::max(p.z(), 1e-3);
    return Eigen::Vector2d(p.x() / z, p.y() / z);
  };
  for (int i = 0; i <= kSteps; ++i) {
    const double x = (raw.width - 1.0) * i / kSteps, y = (raw.height - 1.0) * i / kSteps;
    rect.left = std::max(rect.left, on_plane(0, y).x());
    rect.right = std::min(rect.right, on_plane(raw.width - 1, y).x());
    rect.top = std::max(rect.top, on_plane(x, 0).y());
    rect.bottom = std::min(rect.bottom, on_plane(x, raw.height - 1).y());
  }
  return rect;
}

// Pinhole camera of the given size whose whole image lies inside `rect`.
Camera FittingCamera(int width, int height, const PlaneRect& rect) {
  const double wide = rect.right - rect.left, high = rect.bottom - rect.top;
  if (!(wide > 1e-3 && high > 1e-3))
    ThrowInput("the calibration leaves no common image area after rectification");
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = std::max((width - 1) / wide, (height - 1) / high);
  camera.cx = (width - 1) / 2.0 - camera.fx * (rect.left + rect.right) / 2;
  camera.cy = (height - 1) / 2.0 - camera.fy * (rect.top + rect.bottom) / 2;
  return camera;
}

RectifyMap MakeMap(const RawCamera& raw, const Camera& camera,
                   const Eigen::Matrix3d& R_raw_rectified) {
  cv::Mat map(camera.height, camera.width, CV_32FC2);
  for (int v = 0; v < map.rows; ++v) {
    auto* row = map.ptr<cv::Vec2f>(v);
    for (int u = 0; u < map.cols; ++u) {
      const Eigen::Vector3d p = R_raw_rectified * camera.Unproject(Eigen::Vector2d(u, v));
      // A pinhole lens does not see points behind it, but its distortion polynomial would map them
      // into the image.
      const bool seen = raw.lens == Lens::kFisheye || p.z() > 1e-3;
      const Eigen::Vector2d pixel = seen ? raw.Project(p) : Eigen::Vector2d(-100, -100);
      row[u] = {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
    }
  }
  RectifyMap out;
  cv::convertMaps(map, cv::noArray(), out.coarse, out.fine, CV_16SC2);
  cv::convertMaps(map, cv::noArray(), out.nearest, cv::noArray(), CV_16SC2, true);
  return out;
}

double PlaneLimit(double max_fov_degrees) {
  return std::tan(max_fov_degrees * std::numbers::pi / 360);
}

}  // namespace

cv::Mat RectifyMap::Apply(const cv::Mat& image) const {
  cv::Mat out;
  cv::remap(image, out, coarse, fine, cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar::all(0));
  return out;
}

cv::Mat RectifyMap::ApplyNearest(const cv::Mat& depth) const {
  cv::Mat out;
  cv::remap(depth, out, nearest, cv::noArray(), cv::INTER_NEAREST, cv::BORDER_CONSTANT,
            cv::Scalar::all(0));
  return out;
}

RectifiedCamera RectifyOne(const RawCamera& raw, double max_fov_degrees) {
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  RectifiedCamera out;
  out.camera =
      FittingCamera(raw.width, raw.height, CoveredRect(raw, identity, PlaneLimit(max_fov_degrees)));
  out.map = MakeMap(raw, out.camera, identity);
  return out;
}

RectifiedPair RectifyStereo(const RawCamera& left, const RawCamera& right, const Se3& T_left_right,
                            double max_fov_degrees) {
  if (left.width != right.width || left.height != right.height) {
    ThrowInput("the left camera has " + std::to_string(left.width) + "x" +
               std::to_string(left.height) + " pixels, the right one " +
               std::to_string(right.width) + "x" + std::to_string(right.height) +
               ": a stereo pair needs equal sizes");
  }
  const double baseline = T_left_right.t.norm();
  if (!(baseline > 1e-6) || T_left_right.t.x() < 0.5 * baseline) {
    ThrowInput(
        "the right camera is not to the right of the left one (T_left_right's translation is " +
        std::to_string(T_left_right.t.x()) + " " + std::to_string(T_left_right.t.y()) + " " +
        std::to_string(T_left_right.t.z()) + " m): are the cameras swapped?");
  }
  // Rectified axes in the left camera's frame: x along the baseline, z as close as possible to the
  // mean viewing direction.
  const Eigen::Vector3d x = T_left_right.t / baseline;
  const Eigen::Vector3d looking = (Eigen::Vector3d::UnitZ() + T_left_right.R.col(2)).normalized();
  const Eigen::Vector3d y = looking.cross(x).normalized();
  RectifiedPair out;
  out.R_left_rectified << x, y, x.cross(y);
  const Eigen::Matrix3d R_right_rectified = T_left_right.R.transpose() * out.R_left_rectified;

  const double limit = PlaneLimit(max_fov_degrees);
  const PlaneRect a = CoveredRect(left, out.R_left_rectified, limit);
  const PlaneRect b = CoveredRect(right, R_right_rectified, limit);
  out.camera = FittingCamera(left.width, left.height,
                             {std::max(a.left, b.left), std::min(a.right, b.right),
                              std::max(a.top, b.top), std::min(a.bottom, b.bottom)});
  out.camera.baseline = baseline;
  out.left = MakeMap(left, out.camera, out.R_left_rectified);
  out.right = MakeMap(right, out.camera, R_right_rectified);
  return out;
}

}  // namespace alidade
