#include "alidade/view/cloud_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "alidade/view/upright.h"

namespace alidade {
namespace {

constexpr int kFiner = 2;  // oversampling factor, for anti-aliasing
const cv::Vec3b kBackground(27, 23, 20), kGray(190, 190, 190);  // blue green red
const cv::Scalar kPathColor(255, 169, 90), kStartColor(80, 200, 60);

// Axes of the virtual camera as rows: right, down, forward.
Eigen::Matrix3d ViewAxes(const Eigen::Matrix3d& upright, CloudView view) {
  // viewing direction as right, forward, up
  const Eigen::Vector3d look = [&]() -> Eigen::Vector3d {
    switch (view) {
      case CloudView::kBehind:
        return {-0.3, 1, -0.3};
      case CloudView::kFront:
        return {0, 1, 0};
      case CloudView::kSide:
        return {-1, 0, -0.2};
      case CloudView::kAbove:
        break;
    }
    return {0, 0, -1};
  }();
  const Eigen::Vector3d up =
      view == CloudView::kAbove ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
  Eigen::Matrix3d axes;
  axes.row(2) = look.normalized();
  axes.row(0) = look.cross(up).normalized();
  axes.row(1) = axes.row(2).cross(axes.row(0));
  return axes * upright;
}

// Quantile of unsorted values; `share` 0..1.
double Quantile(std::vector<double> values, double share) {
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<size_t>(rank)];
}

// The virtual pinhole camera; p_eye is right, down, forward.
struct Eye {
  Eigen::Matrix3d axes;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // of the scene, along the axes
  double distance = 1;                               // from the camera to the center
  double focal = 1, cx = 0, cy = 0;                  // pixels

  Eigen::Vector3d Place(const Eigen::Vector3d& p_world) const {
    Eigen::Vector3d p = axes * p_world - centre;
    p.z() += distance;
    return p;
  }
  Eigen::Vector3d Centre() const {  // position of the camera in the world
    return axes.transpose() * (centre - Eigen::Vector3d(0, 0, distance));
  }
  double Nearest() const { return 0.05 * distance; }
  Eigen::Vector2d Project(const Eigen::Vector3d& p_eye) const {
    return {focal * p_eye.x() / p_eye.z() + cx, focal * p_eye.y() / p_eye.z() + cy};
  }
};

// Range that contains most of the values.
struct Range {
  double low = 0, high = 0;
  double Middle() const { return 0.5 * (low + high); }
};
Range MostOf(const std::vector<double>& values, double left_out) {
  return {Quantile(values, left_out), Quantile(values, 1 - left_out)};
}

// What the image must show, along the camera's axes: a sample of the points and all of the path.
struct Subject {
  std::vector<Eigen::Vector3d> points, path;
};

Subject SubjectOf(const CloudScene& scene, const Eigen::Matrix3d& axes) {
  constexpr size_t kEnough = 50000;  // number of points that determines the quantiles well
  Subject subject;
  const size_t step = 1 + scene.cloud.points.size() / kEnough;
  for (size_t i = 0; i < scene.cloud.points.size(); i += step)
    subject.points.push_back(axes * scene.cloud.points[i].cast<double>());
  for (const auto& stretch : scene.path) {
    for (const Se3& T : stretch) subject.path.push_back(axes * T.t);
  }
  if (subject.points.empty()) subject.points = subject.path;
  if (subject.points.empty()) subject.points.push_back(Eigen::Vector3d::Zero());
  return subject;
}

Eye LookAt(const CloudScene& scene, CloudView view, const CloudPictureSettings& settings) {
  Eye eye;
  eye.axes = ViewAxes(UprightAxes(scene.path, scene.gravity), view);
  const double width = kFiner * settings.width, height = kFiner * settings.height;
  const double wide = std::tan(0.5 * settings.field_of_view * std::numbers::pi / 180);
  const double tall = wide * height / width;
  eye.focal = 0.5 * width / wide;
  eye.cx = 0.5 * (width - 1);
  eye.cy = 0.5 * (height - 1);

  const Subject subject = SubjectOf(scene, eye.axes);
  const double left_out = settings.least_percent / 100;
  std::vector<double> values(subject.points.size());
  const auto of_points = [&](const auto& value) -> const std::vector<double>& {
    for (size_t i = 0; i < values.size(); ++i) values[i] = value(subject.points[i]);
    return values;
  };
  for (int axis = 0; axis < 3; ++axis) {
    const auto along = [&](const Eigen::Vector3d& p) { return p[axis]; };
    eye.centre[axis] = MostOf(of_points(along), left_out).Middle();
  }
  // Distance at which a point is inside the image.
  const auto needed = [&](const Eigen::Vector3d& p) {
    const Eigen::Vector3d q = p - eye.centre;
    return std::max(std::abs(q.x()) / wide, std::abs(q.y()) / tall) - q.z();
  };
  const auto fit = [&] {
    eye.distance = Quantile(of_points(needed), 1 - left_out);
    for (const Eigen::Vector3d& p : subject.path) eye.distance = std::max(eye.distance, needed(p));
    eye.distance = std::max(1.05 * eye.distance, 1e-6);
  };
  fit();
  // Perspective shifts the visible center, because near points appear larger: center the projected
  // range.
  for (int round = 0; round < 4; ++round) {
    for (int axis = 0; axis < 2; ++axis) {
      const auto slope = [&](const Eigen::Vector3d& p) {
        const Eigen::Vector3d q = p - eye.centre;
        return q[axis] / std::max(q.z() + eye.distance, eye.Nearest());
      };
      Range range = MostOf(of_points(slope), left_out);
      for (const Eigen::Vector3d& p : subject.path) {
        range.low = std::min(range.low, slope(p));
        range.high = std::max(range.high, slope(p));
      }
      eye.centre[axis] += range.Middle() * eye.distance;
    }
    fit();
  }
  return eye;
}

struct Dot {
  float x, y, z;    // pixels, and depth
  uint32_t number;  // of the point
  cv::Vec3b color;
};

// A sample of the path's poses, used to find from where a point was seen.
std::vector<Se3> Witnesses(const CloudScene& scene) {
  constexpr size_t kMost = 64;
  std::vector<Se3> all, some;
  for (const auto& stretch : scene.path) all.insert(all.end(), stretch.begin(), stretch.end());
  const size_t step = 1 + all.size() / kMost;
  for (size_t i = 0; i < all.size(); i += step) some.push_back(all[i]);
  return some;
}

// true when the surface at `p` faces away from the virtual camera: the nearest path camera that had
// `p` in its view looked from the other side. Surfaces seen from above, such as floors, are never
// excluded.
bool ShowsItsBack(const Eigen::Vector3d& p, const Eigen::Vector3d& p_eye, const Eigen::Vector3d& up,
                  const std::vector<Se3>& witnesses) {
  // Cosine of the angle to the optical axis, approximately the image.
  constexpr double kAhead = 0.8;
  constexpr double kDown = 0.42;  // sine of 25°
  double nearest = std::numeric_limits<double>::infinity();
  Eigen::Vector3d from = Eigen::Vector3d::Zero();  // direction from p to the camera that saw it
  for (const Se3& T : witnesses) {
    const Eigen::Vector3d ray = p - T.t;
    const double length = ray.norm();
    if (length >= nearest || ray.dot(T.R.col(2)) < kAhead * length) continue;
    nearest = length;
    from = -ray;
  }
  if (up.dot(from) > kDown * from.norm()) return false;
  const auto cosine = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return a.dot(b) / std::max(a.norm() * b.norm(), 1e-12);
  };
  const auto level = [&](const Eigen::Vector3d& v) -> Eigen::Vector3d {
    return v - up * up.dot(v);
  };
  const Eigen::Vector3d to_eye = p_eye - p;
  const bool from_the_side = level(to_eye).norm() > 0.5 * to_eye.norm();
  return cosine(from, to_eye) < -0.7 ||
         (from_the_side && cosine(level(from), level(to_eye)) < -0.3);
}

// Gamma correction, so that dark points stand out from the dark background.
cv::Vec3b Lifted(const std::array<uint8_t, 3>& rgb) {
  static const std::array<uint8_t, 256> kLift = [] {
    std::array<uint8_t, 256> lift{};
    for (size_t i = 0; i < lift.size(); ++i)
      lift[i] =
          static_cast<uint8_t>(std::lround(255 * std::pow(static_cast<double>(i) / 255, 0.8)));
    return lift;
  }();
  return {kLift[rgb[2]], kLift[rgb[1]], kLift[rgb[0]]};
}

std::vector<Dot> Dots(const CloudScene& scene, const Eye& eye, cv::Size size, double most_sigma) {
  const Cloud& cloud = scene.cloud;
  const std::vector<Se3> witnesses = Witnesses(scene);
  const Eigen::Vector3d p_eye = eye.Centre(), up = UprightAxes(scene.path, scene.gravity).row(2);
  std::vector<Dot> dots;
  dots.reserve(cloud.points.size());
  for (size_t i = 0; i < cloud.points.size(); ++i) {
    if (!cloud.sigmas.empty() && cloud.sigmas[i] > most_sigma * eye.distance) continue;
    const Eigen::Vector3d p_world = cloud.points[i].cast<double>();
    const Eigen::Vector3d p = eye.Place(p_world);
    if (!(p.z() > eye.Nearest())) continue;
    const Eigen::Vector2d pixel = eye.Project(p);
    if (!(pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < size.width && pixel.y() < size.height))
      continue;
    if (ShowsItsBack(p_world, p_eye, up, witnesses)) continue;
    dots.push_back({static_cast<float>(pixel.x()), static_cast<float>(pixel.y()),
                    static_cast<float>(p.z()), static_cast<uint32_t>(i),
                    cloud.colors.empty() ? kGray : Lifted(cloud.colors[i])});
  }
  return dots;
}

// Radius in pixels with which the dots approximately fill the occupied parts of the image.
double DotRadius(const std::vector<Dot>& dots, cv::Size size) {
  constexpr int kCell = 16;
  cv::Mat1b met(size.height / kCell + 1, size.width / kCell + 1, uchar{0});
  for (const Dot& dot : dots)
    met(static_cast<int>(dot.y) / kCell, static_cast<int>(dot.x) / kCell) = 1;
  const double area = kCell * kCell * cv::countNonZero(met);
  const double spacing = std::sqrt(area / static_cast<double>(std::max<size_t>(1, dots.size())));
  return std::clamp(0.8 * spacing, 1.0, 4.0);
}

void Splat(const Dot& dot, double radius, cv::Mat3b& picture) {
  const int left = std::max(0, static_cast<int>(std::ceil(dot.x - radius)));
  const int right = std::min(picture.cols - 1, static_cast<int>(std::floor(dot.x + radius)));
  const int top = std::max(0, static_cast<int>(std::ceil(dot.y - radius)));
  const int bottom = std::min(picture.rows - 1, static_cast<int>(std::floor(dot.y + radius)));
  for (int y = top; y <= bottom; ++y) {
    for (int x = left; x <= right; ++x) {
      const double dx = x - dot.x, dy = y - dot.y;
      if (dx * dx + dy * dy <= radius * radius) picture(y, x) = dot.color;
    }
  }
}

void DrawLine(const Eigen::Vector3d& p_world, const Eigen::Vector3d& q_world, const Eye& eye,
              const cv::Scalar& color, cv::Mat3b& picture) {
  constexpr int kFractionBits = 4;
  const Eigen::Vector3d p = eye.Place(p_world), q = eye.Place(q_world);
  if (std::min(p.z(), q.z()) <= eye.Nearest()) return;
  const auto at = [&](const Eigen::Vector3d& p_eye) {
    const Eigen::Vector2d pixel = eye.Project(p_eye) * (1 << kFractionBits);
    return cv::Point(static_cast<int>(std::lround(pixel.x())),
                     static_cast<int>(std::lround(pixel.y())));
  };
  cv::line(picture, at(p), at(q), color, kFiner + 1, cv::LINE_AA, kFractionBits);
}

// From far to near, so that no depth per pixel must be stored. Of equally near ones the first is in
// front.
void SortByDepth(std::vector<Dot>& dots) {
  std::sort(dots.begin(), dots.end(), [](const Dot& a, const Dot& b) {
    return a.z > b.z || (a.z == b.z && a.number > b.number);
  });
}

// Draws a camera as a viewing pyramid of length `size`.
void DrawCamera(const Se3& T_world_camera, double size, const Eye& eye, cv::Mat3b& picture) {
  std::array<Eigen::Vector3d, 4> corners;
  for (size_t i = 0; i < 4; ++i) {
    const double x = i == 0 || i == 3 ? -0.6 : 0.6, y = i < 2 ? -0.45 : 0.45;
    corners[i] = T_world_camera * (size * Eigen::Vector3d(x, y, 1));
  }
  for (size_t i = 0; i < 4; ++i) {
    DrawLine(T_world_camera.t, corners[i], eye, kStartColor, picture);
    DrawLine(corners[i], corners[(i + 1) % 4], eye, kStartColor, picture);
  }
}

void DrawPath(const CloudScene& scene, const Eye& eye, cv::Mat3b& picture) {
  for (const auto& stretch : scene.path) {
    for (size_t i = 1; i < stretch.size(); ++i)
      DrawLine(stretch[i - 1].t, stretch[i].t, eye, kPathColor, picture);
  }
  if (!scene.path.empty())
    DrawCamera(scene.path.front().front(), 0.03 * eye.distance, eye, picture);
}

}  // namespace

cv::Mat DrawCloud(const CloudScene& scene, CloudView view, const CloudPictureSettings& settings) {
  const cv::Size size(kFiner * settings.width, kFiner * settings.height);
  cv::Mat3b picture(size, kBackground);
  const Eye eye = LookAt(scene, view, settings);
  std::vector<Dot> dots = Dots(scene, eye, size, settings.most_sigma);
  SortByDepth(dots);
  const double radius = DotRadius(dots, size);
  for (const Dot& dot : dots) Splat(dot, radius * eye.distance / dot.z, picture);
  DrawPath(scene, eye, picture);
  cv::Mat scaled;
  cv::resize(picture, scaled, {settings.width, settings.height}, 0, 0, cv::INTER_AREA);
  return scaled;
}

}  // namespace alidade
