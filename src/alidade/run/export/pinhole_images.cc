#include "alidade/run/export/pinhole_images.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "alidade/base/error.h"

namespace alidade {
namespace {

constexpr int kBorderSteps = 256;  // points on each side of the image
constexpr double kMostWiden = 2;   // pinhole width / recorded width
constexpr int kGridStep = 8;       // pixels; bilinear in between is right to about 0.02 pixels
constexpr int kReadoutRounds = 3;  // each shrinks the error of the row's time by readout × speed
constexpr double kLeastForward = 0.1;

// Rectangle on the plane z = 1.
struct PinholeRect {
  double left = -HUGE_VAL, right = HUGE_VAL, top = -HUGE_VAL, bottom = HUGE_VAL;
};

// From pixels of the map's camera to those of an image of `size`, and back.
double Scaled(double v, double from, double to) { return (v + 0.5) * to / from - 0.5; }

cv::Mat Resampled(const cv::Mat& image, const cv::Mat& positions, int interpolation) {
  if (positions.empty()) return image;
  cv::Mat out;
  cv::remap(image, out, positions, cv::noArray(), interpolation, cv::BORDER_REPLICATE);
  return out;
}

}  // namespace

PinholeImages::PinholeImages(const Camera& map_camera, cv::Size recorded,
                             const PinholeSettings& settings)
    : map_(map_camera), recorded_(recorded) {
  const double to_x = static_cast<double>(recorded.width) / map_.width,
               to_y = static_cast<double>(recorded.height) / map_.height;
  const auto on_plane = [&](double x, double y) {  // of a recorded pixel
    const Eigen::Vector3d p = map_.Unproject(map_.Undistort(
        {Scaled(x, recorded.width, map_.width), Scaled(y, recorded.height, map_.height)}));
    return Eigen::Vector2d(p.x(), p.y());
  };
  PinholeRect rect;
  for (int i = 0; i <= kBorderSteps; ++i) {
    const double x = (recorded.width - 1.0) * i / kBorderSteps,
                 y = (recorded.height - 1.0) * i / kBorderSteps;
    rect.left = std::max(rect.left, on_plane(0, y).x());
    rect.right = std::min(rect.right, on_plane(recorded.width - 1, y).x());
    rect.top = std::max(rect.top, on_plane(x, 0).y());
    rect.bottom = std::min(rect.bottom, on_plane(x, recorded.height - 1).y());
  }
  rect.left += settings.margin.x() / map_.fx;
  rect.right -= settings.margin.x() / map_.fx;
  rect.top += settings.margin.y() / map_.fy;
  rect.bottom -= settings.margin.y() / map_.fy;
  if (settings.centered) {
    rect.right = std::min(rect.right, -rect.left);
    rect.left = -rect.right;
    rect.bottom = std::min(rect.bottom, -rect.top);
    rect.top = -rect.bottom;
  }
  if (!(rect.right > rect.left && rect.bottom > rect.top))
    ThrowInput("the camera leaves no image without its distortion: is the calibration right?");
  double fx = map_.fx * to_x, fy = map_.fy * to_y;
  const double wide = std::max((rect.right - rect.left) * fx / (kMostWiden * recorded.width),
                               (rect.bottom - rect.top) * fy / (kMostWiden * recorded.height));
  if (wide > 1) {
    fx /= wide;
    fy /= wide;
  }
  constexpr double kRounding = 1e-6;  // pixels: without distortion the whole image fits
  pinhole_.width = static_cast<int>(std::floor((rect.right - rect.left) * fx + kRounding)) + 1;
  pinhole_.height = static_cast<int>(std::floor((rect.bottom - rect.top) * fy + kRounding)) + 1;
  pinhole_.fx = fx;
  pinhole_.fy = fy;
  // What is less than a pixel is left on both sides alike.
  pinhole_.cx = (pinhole_.width - 1) / 2.0 - fx * (rect.left + rect.right) / 2;
  pinhole_.cy = (pinhole_.height - 1) / 2.0 - fy * (rect.top + rect.bottom) / 2;
  pinhole_.fps = map_.fps;
  constexpr double kSame = 1e-3;  // pixels
  same_ = !map_.HasDistortion() && pinhole_.width == recorded.width &&
          pinhole_.height == recorded.height &&
          (Source({0, 0}, {}) - Eigen::Vector2d(0, 0)).norm() < kSame &&
          std::abs(fx - map_.fx * to_x) < kSame;
  if (!same_) at_rest_ = Positions({});
}

Eigen::Vector2d PinholeImages::InRecorded(const Eigen::Vector2d& raw) const {
  return {Scaled(raw.x(), map_.width, recorded_.width),
          Scaled(raw.y(), map_.height, recorded_.height)};
}

// The position in the recorded image that a pinhole pixel shows. When it was read depends on where
// it is, so that is a fixed point.
Eigen::Vector2d PinholeImages::Source(const Eigen::Vector2d& pixel,
                                      const ReadoutMotion& readout) const {
  const Eigen::Vector3d ray = pinhole_.Unproject(pixel);
  Eigen::Vector2d raw = map_.Distort(map_.Project(ray));
  if (Moves(readout)) {
    for (int round = 0; round < kReadoutRounds; ++round) {
      const Se3 later = Se3::Exp(map_.ReadAfterMiddle(raw.x(), raw.y()) * readout.motion);
      const Eigen::Vector3d p = later.R * ray + readout.inverse_depth * later.t;
      if (!(p.z() > kLeastForward)) break;
      raw = map_.Distort(map_.Project(p));
    }
  }
  return InRecorded(raw);
}

Eigen::Vector2d PinholeImages::InPinhole(const Eigen::Vector2d& raw,
                                         const ReadoutMotion& readout) const {
  Eigen::Vector3d ray = map_.Unproject(map_.Undistort(raw));
  if (Moves(readout)) {  // p at the time of the row = R ray + w t, up to its length
    const Se3 later = Se3::Exp(map_.ReadAfterMiddle(raw.x(), raw.y()) * readout.motion);
    // The length follows from z = 1 of the ray in the middle of the image.
    const Eigen::Vector3d direction = later.R.transpose() * ray,
                          moved = later.R.transpose() * later.t * readout.inverse_depth;
    const double length = (1 + moved.z()) / direction.z();
    const Eigen::Vector3d p = length * direction - moved;
    if (p.z() > kLeastForward) ray = p;
  }
  return pinhole_.Project(ray);
}

bool PinholeImages::Holds(const Eigen::Vector2d& pixel) const {
  return pixel.x() >= -0.5 && pixel.y() >= -0.5 && pixel.x() < pinhole_.width - 0.5 &&
         pixel.y() < pinhole_.height - 0.5;
}

bool PinholeImages::Moves(const ReadoutMotion& readout) const {
  return map_.RollingShutter() && !readout.motion.isZero();
}

// Computed on a grid, bilinear in between.
cv::Mat PinholeImages::Positions(const ReadoutMotion& readout, cv::Mat positions) const {
  const int columns = (pinhole_.width - 1) / kGridStep + 2,
            rows = (pinhole_.height - 1) / kGridStep + 2;
  std::vector<Eigen::Vector2d> grid(static_cast<size_t>(columns) * static_cast<size_t>(rows));
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c)
      grid[static_cast<size_t>(r) * static_cast<size_t>(columns) + static_cast<size_t>(c)] =
          Source(Eigen::Vector2d(c, r) * kGridStep, readout);
  }
  positions.create(pinhole_.height, pinhole_.width, CV_32FC2);
  for (int y = 0; y < positions.rows; ++y) {
    auto* row = positions.ptr<cv::Vec2f>(y);
    const auto* above = &grid[static_cast<size_t>(y / kGridStep) * static_cast<size_t>(columns)];
    const auto* below = above + columns;
    const double v = static_cast<double>(y % kGridStep) / kGridStep;
    for (int x = 0; x < positions.cols; ++x) {
      const int c = x / kGridStep;
      const double u = static_cast<double>(x % kGridStep) / kGridStep;
      const Eigen::Vector2d p = (1 - v) * ((1 - u) * above[c] + u * above[c + 1]) +
                                v * ((1 - u) * below[c] + u * below[c + 1]);
      row[x] = {static_cast<float>(p.x()), static_cast<float>(p.y())};
    }
  }
  return positions;
}

cv::Mat PinholeImages::PositionsAt(const ReadoutMotion& readout, cv::Mat buffer) const {
  if (!Moves(readout)) return same_ ? cv::Mat() : at_rest_;
  if (buffer.data == at_rest_.data) buffer.release();
  return Positions(readout, std::move(buffer));
}

cv::Mat PinholeImages::Apply(const cv::Mat& image, const ReadoutMotion& readout) const {
  return Resampled(image, PositionsAt(readout), cv::INTER_CUBIC);
}

cv::Mat PinholeImages::ApplyNearest(const cv::Mat& mask, const ReadoutMotion& readout) const {
  return Nearest(mask, PositionsAt(readout));
}

cv::Mat PinholeImages::Nearest(const cv::Mat& image, const cv::Mat& positions) {
  return Resampled(image, positions, cv::INTER_NEAREST);
}

}  // namespace alidade
