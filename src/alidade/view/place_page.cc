#include "alidade/view/place_page.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "alidade/base/print.h"
#include "alidade/view/svg.h"
#include "alidade/view/upright.h"

namespace alidade {
namespace {

constexpr double kMargin = 30;  // pixels
constexpr size_t kMostDots = 8000;

// The range without the outermost 2 % on either side.
std::array<double, 2> MiddleRange(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto rank = [&](double share) {
    return values[static_cast<size_t>(share * static_cast<double>(values.size() - 1))];
  };
  return {rank(0.02), rank(0.98)};
}

Eigen::Matrix<double, 2, 3> AxesOf(const DrawnPath& path, PlaceView view,
                                   const std::optional<Eigen::Vector3d>& gravity) {
  const Eigen::Matrix3d axes = UprightAxes(path, gravity);  // rows: right, forward, up
  if (view == PlaceView::kAbove) return axes.topRows<2>();
  Eigen::Vector3d low = Eigen::Vector3d::Constant(INFINITY), high = -low;
  for (const auto& stretch : path) {
    for (const Se3& T : stretch) {
      low = low.cwiseMin(axes * T.t);
      high = high.cwiseMax(axes * T.t);
    }
  }
  Eigen::Matrix<double, 2, 3> side;
  side << axes.row(high.y() - low.y() > high.x() - low.x() ? 1 : 0), axes.row(2);
  return side;
}

}  // namespace

PlacePage::PlacePage(const std::vector<DrawnPath>& paths,
                     const std::vector<Eigen::Vector3d>& landmarks, const DrawnPath& upright,
                     PlaceView view, const std::optional<Eigen::Vector3d>& gravity)
    : axes_(AxesOf(upright, view, gravity)), height_(view == PlaceView::kAbove ? 620 : 320) {
  std::vector<Eigen::Vector2d> points;
  for (const DrawnPath& path : paths) {
    for (const auto& stretch : path) {
      for (const Se3& T : stretch) points.emplace_back(axes_ * T.t);
    }
  }
  if (!landmarks.empty()) {
    std::vector<double> xs, ys;
    for (const auto& p : landmarks) {
      const Eigen::Vector2d q = axes_ * p;
      xs.push_back(q.x());
      ys.push_back(q.y());
    }
    const auto x = MiddleRange(std::move(xs)), y = MiddleRange(std::move(ys));
    points.emplace_back(x[0], y[0]);
    points.emplace_back(x[1], y[1]);
  }
  if (points.empty()) points.emplace_back(0, 0);
  low_ = high_ = points.front();
  for (const auto& p : points) {
    low_ = low_.cwiseMin(p);
    high_ = high_.cwiseMax(p);
  }
  const Eigen::Vector2d size = (high_ - low_).cwiseMax(1e-6);
  scale_ = std::min((kPictureWidth - 2 * kMargin) / size.x(), (height_ - 2 * kMargin) / size.y());
}

Eigen::Vector2d PlacePage::At(const Eigen::Vector3d& p) const {
  const Eigen::Vector2d from_middle = scale_ * (axes_ * p - 0.5 * (low_ + high_));
  return {kPictureWidth / 2 + from_middle.x(), height_ / 2 - from_middle.y()};
}

std::string PlacePage::Lines(const DrawnPath& path, const std::string& name) const {
  std::string svg;
  for (const auto& stretch : path) {
    std::string points;
    for (const Se3& T : stretch) {
      const Eigen::Vector2d p = At(T.t);
      points += SvgNumber(p.x()) + "," + SvgNumber(p.y()) + " ";
    }
    svg += "<polyline class=\"" + name + "\" points=\"" + points + "\"/>\n";
  }
  return svg;
}

// Dots are zero-length strokes with round caps, the most compact encoding.
std::string PlacePage::Dots(const std::vector<Eigen::Vector3d>& points,
                            const std::string& name) const {
  const size_t step = 1 + points.size() / kMostDots;
  std::string data;
  for (size_t i = 0; i < points.size(); i += step) {
    const Eigen::Vector2d p = At(points[i]);
    const bool inside = p.x() >= 0 && p.y() >= 0 && p.x() <= kPictureWidth && p.y() <= height_;
    if (inside) data += "M" + SvgNumber(p.x()) + " " + SvgNumber(p.y()) + "h0";
  }
  return "<path class=\"" + name + "\" d=\"" + data + "\"/>\n";
}

std::string PlacePage::Marker(const Eigen::Vector3d& p, const std::string& name) const {
  const Eigen::Vector2d at = At(p);
  return "<circle class=\"" + name + "\" cx=\"" + SvgNumber(at.x()) + "\" cy=\"" +
         SvgNumber(at.y()) + "\" r=\"5\"/>\n";
}

std::string PlacePage::ScaleBar(const std::string& unit) const {
  return SvgScaleBar(scale_, height_, unit);
}

}  // namespace alidade
