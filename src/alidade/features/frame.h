// What one moment of the camera becomes: keypoints with descriptors and, where known, depth.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/features/descriptor.h"
#include "alidade/features/picture.h"
#include "alidade/geometry/camera.h"

namespace ALIDADE_API alidade {

// Image pyramid geometry: level l is the image scaled by 1 / ScaleOfLevel(l).
inline constexpr int kPyramidLevels = 8;
inline constexpr double kPyramidScale = 1.2;
double ScaleOfLevel(int level);  // 1.2^level, from a table

struct Keypoint {
  float x = 0, y = 0;          // undistorted, pixels of level 0
  float raw_x = 0, raw_y = 0;  // as in the image, pixels of level 0
  float angle = 0;             // orientation of the patch, radians in (-pi, pi]
  float response = 0;          // corner strength (FAST score)
  float right_x =
      kNoDepth;  // column in the rectified right image, or x - bf / depth; kNoDepth when unknown
  float depth = kNoDepth;  // metres along z; kNoDepth when unknown
  int level = 0;           // pyramid level it was found on

  static constexpr float kNoDepth = -1;
  bool has_depth() const { return depth > 0; }
  Eigen::Vector2d pixel() const { return {x, y}; }
};

// Finds the keypoints near a place in constant time. Cells of kCell pixels over the undistorted
// image.
class KeypointGrid {
 public:
  static constexpr int kCell = 16;  // pixels
  KeypointGrid() = default;
  KeypointGrid(std::span<const Keypoint> keypoints, int width, int height);
  // Calls visit(index) for every keypoint whose cell touches the square of half-width `radius`
  // around (x, y), in order of cells, then of indices. The caller checks the exact distance.
  template <typename Visit>
  void VisitNear(float x, float y, float radius, Visit&& visit) const;

 private:
  int columns_ = 0, rows_ = 0;
  float left_ = 0, top_ = 0;  // undistorted keypoints may lie outside the image
  std::vector<int> first_;    // per cell, index into order_; one more at the end
  std::vector<int> order_;    // keypoint indices, cell by cell
};

// Immutable once made; shared between tracker, map and workers.
struct Frame {
  double time = 0;  // seconds
  int number = 0;   // counted from 0 in the recording
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;  // one for each keypoint
  // How likely each keypoint is part of what stands still, 0…1. Empty: nothing is known to move.
  std::vector<float> static_probability;
  KeypointGrid grid;
  cv::Mat image;                 // 8 bit grey, level 0, as given (not undistorted)
  std::vector<cv::Mat> pyramid;  // all levels; empty once the frame is a keyframe (memory)
  cv::Mat glance;  // Glance() of the image while one camera is to start a map; else empty
  // How the camera moved while the image was read, where known: T_camera_world was
  // Exp(s motion) T_camera_world s seconds after its middle. Map units and radians, per second.
  Vector6d motion = Vector6d::Zero();
  std::shared_ptr<const Picture> picture;  // for dense work, until it is handed over; else null

  // Keypoints less likely to stand still than this take no part in the pose, and less likely ones
  // than kMappable none in the map.
  static constexpr float kUsable = 0.05f, kMappable = 0.5f;
  float Static(int keypoint) const {
    return static_probability.empty() ? 1.0f : static_probability[keypoint];
  }
  bool IsUsable(int keypoint) const { return Static(keypoint) >= kUsable; }
};

template <typename Visit>
void KeypointGrid::VisitNear(float x, float y, float radius, Visit&& visit) const {
  const auto cell = [](float v, int limit) {
    const int c = static_cast<int>(v / kCell) - (v < 0 ? 1 : 0);
    return c < 0 ? 0 : (c >= limit ? limit - 1 : c);
  };
  if (columns_ == 0) return;
  const int c0 = cell(x - radius - left_, columns_), c1 = cell(x + radius - left_, columns_);
  const int r0 = cell(y - radius - top_, rows_), r1 = cell(y + radius - top_, rows_);
  for (int r = r0; r <= r1; ++r) {
    const int begin = first_[r * columns_ + c0], end = first_[r * columns_ + c1 + 1];
    for (int i = begin; i < end; ++i) visit(order_[i]);
  }
}

}  // namespace alidade
