// The picture in cells of some 8 × 8 pixels: fine enough for people, few enough to look at all.
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

// Cells of the image as taken, lens distortion and all, row by row.
class Cells {
 public:
  static constexpr int kColumns = 80;
  explicit Cells(const Camera& camera);

  int columns() const { return kColumns; }
  int rows() const { return rows_; }
  int count() const { return kColumns * rows_; }
  float size() const { return size_; }  // pixels
  // Cell of a raw pixel; outside the image the nearest.
  int At(float x, float y) const;
  cv::Point2f Centre(int cell) const;  // raw pixel
  // Point at depth 1 on the ray through the cell's centre.
  const Eigen::Vector3d& Ray(int cell) const { return rays_[cell]; }
  // Cell that shows a point of the camera's frame; -1: behind the camera or out of the picture.
  int Project(const Eigen::Vector3d& p) const;
  // Calls visit(neighbour) for the cell and those around it, inside the picture.
  template <typename Visit>
  void VisitAround(int cell, int reach, Visit&& visit) const;

 private:
  Camera camera_;
  bool distorted_;
  float size_;
  int rows_;
  std::vector<Eigen::Vector3d> rays_;
  double reach2_ = 0;  // squared distance from the axis at depth 1 that is seen, with some more
};

template <typename Visit>
void Cells::VisitAround(int cell, int reach, Visit&& visit) const {
  const int r = cell / kColumns, c = cell % kColumns;
  for (int y = std::max(0, r - reach); y <= std::min(rows_ - 1, r + reach); ++y) {
    for (int x = std::max(0, c - reach); x <= std::min(kColumns - 1, c + reach); ++x)
      visit(y * kColumns + x);
  }
}

// Whether `other` is not on the surface that `cell` is on: |z' - z| > surface_step z. Depths of all
// cells in metres, 0 = unknown, may be empty; what is unknown is apart from nothing.
inline bool ApartInDepth(std::span<const float> depth, int cell, int other,
                         const CellDepthSettings& settings = {}) {
  return !depth.empty() && depth[other] > 0 && depth[cell] > 0 &&
         std::abs(depth[other] - depth[cell]) > settings.surface_step * depth[cell];
}

// Metres along z in every cell, 0 = unknown: the median of nine readings.
// From a depth image (CV_16U in camera.depth_factor units or CV_32F metres).
std::vector<float> DepthOfCells(const Cells& cells, const Camera& camera, const cv::Mat& depth,
                                const CellDepthSettings& settings = {});
// From a rectified pair (CV_8U), by block matching at half size (Konolige 1998).
std::vector<float> StereoDepthOfCells(const Cells& cells, const Camera& camera, const cv::Mat& left,
                                      const cv::Mat& right, const CellDepthSettings& settings = {});

}  // namespace alidade
