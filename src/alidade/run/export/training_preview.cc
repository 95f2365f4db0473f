#include "alidade/run/export/training_preview.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace alidade {

cv::Mat TrainingPreview(const TrainingSet& set) {
  if (set.shown.empty()) return {};
  struct Dot {
    double depth;
    cv::Point2d at;
    cv::Scalar color;
  };
  const Se3& T_camera_world = set.model.images[static_cast<size_t>(set.shown_image)].T_camera_world;
  std::vector<Dot> dots;
  for (const ColmapModel::Point& point : set.model.points) {
    const Eigen::Vector3d p = T_camera_world * point.p_world;
    if (!(p.z() > 0)) continue;
    const Eigen::Vector2d pixel = set.model.camera.Project(p);
    const bool inside = pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < set.shown.cols &&
                        pixel.y() < set.shown.rows;
    if (!inside) continue;
    const auto& [r, g, b] = point.color;
    dots.push_back({p.z(), {pixel.x(), pixel.y()}, cv::Scalar(b, g, r)});
  }
  std::sort(dots.begin(), dots.end(), [](const Dot& a, const Dot& b) { return a.depth > b.depth; });

  cv::Mat photo = set.shown;
  if (photo.channels() == 1) cv::cvtColor(set.shown, photo, cv::COLOR_GRAY2BGR);
  cv::Mat points = 0.2 * photo;
  constexpr int kShift = 4;  // cv::circle's fixed point: 1/16 pixel
  const int radius = std::max(2, photo.cols / 180);
  for (const Dot& dot : dots) {
    const cv::Point at(cvRound(dot.at.x * (1 << kShift)), cvRound(dot.at.y * (1 << kShift)));
    cv::circle(points, at, radius << kShift, dot.color, cv::FILLED, cv::LINE_AA, kShift);
  }
  cv::Mat both;
  cv::hconcat(photo, points, both);
  return both;
}

}  // namespace alidade
