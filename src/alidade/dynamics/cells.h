// A grid of cells of about 8 × 8 pixels over the image: fine enough for people, few enough to
// process every frame.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "alidade/dynamics/belief_settings.h"
#include "alidade/geometry/camera.h"

namespace alidade {

// Cells of the raw (distorted) image, in row-major order.
class Cells {
 public:
  static constexpr int kColumns = 80;
  explicit Cells(const Camera& camera);

  int columns() const { return kColumns; }
  int rows() const { return rows_; }
  int count() const { return kColumns * rows_; }
  float size() const { return size_; }  // side of a cell, pixels
  // Cell of a raw pixel; for a pixel outside the image the nearest cell.
  int At(float x, float y) const;
  cv::Point2f Centre(int cell) const;  // raw pixel
  // Point at depth 1 on the ray through the cell's center.
  const Eigen::Vector3d& Ray(int cell) const { return rays_[cell]; }
  // Cell in which a point of the camera's frame appears; -1: behind the camera or outside the
  // image.
  int Project(const Eigen::Vector3d& p) const;
  // Calls visit(n) for the cell and those within `reach` cells of it, inside the image.
  template <typename Visit>
  void VisitAround(int cell, int reach, Visit&& visit) const;

 private:
  Camera camera_;
  bool distorted_;
  float size_;
  int rows_;
  std::vector<Eigen::Vector3d> rays_;
  // Squared distance from the optical axis at depth 1 up to which points are visible, with a
  // margin.
  double reach2_ = 0;
};

template <typename Visit>
void Cells::VisitAround(int cell, int reach, Visit&& visit) const {
  const int r = cell / kColumns, c = cell % kColumns;
  for (int y = std::max(0, r - reach); y <= std::min(rows_ - 1, r + reach); ++y) {
    for (int x = std::max(0, c - reach); x <= std::min(kColumns - 1, c + reach); ++x)
      visit(y * kColumns + x);
  }
}

// true when two cells show different surfaces: |z' - z| > surface_step z. `depth`: of all cells,
// meters, 0 = unknown; may be empty. A cell of unknown depth is never apart from another.
inline bool ApartInDepth(std::span<const float> depth, int cell, int other,
                         const CellDepthSettings& settings = {}) {
  return !depth.empty() && depth[other] > 0 && depth[cell] > 0 &&
         std::abs(depth[other] - depth[cell]) > settings.surface_step * depth[cell];
}

// Depth along z of every cell, meters, 0 = unknown: the median of nine readings.
// From a depth image (CV_16U in camera.depth_factor units or CV_32F in meters).
std::vector<float> DepthOfCells(const Cells& cells, const Camera& camera, const cv::Mat& depth,
                                const CellDepthSettings& settings = {});
// From a rectified stereo pair (CV_8U), by block matching at half size (Konolige 1998).
std::vector<float> StereoDepthOfCells(const Cells& cells, const Camera& camera, const cv::Mat& left,
                                      const cv::Mat& right, const CellDepthSettings& settings = {});

}  // namespace alidade
