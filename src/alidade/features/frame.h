// A frame: keypoints of one image with descriptors and, where known, depth.
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

// Pyramid level l is the image scaled by 1 / ScaleOfLevel(l).
inline constexpr int kPyramidLevels = 8;
inline constexpr double kPyramidScale = 1.2;
double ScaleOfLevel(int level);  // 1.2^level, from a table

struct Keypoint {
  float x = 0, y = 0;          // undistorted position, pixels of level 0
  float raw_x = 0, raw_y = 0;  // position in the image, pixels of level 0
  float angle = 0;             // orientation of the patch, radians in (-pi, pi]
  float response = 0;          // corner strength (FAST score)
  // Column in the rectified right image, or x - bf / depth; kNoDepth if unknown.
  float right_x = kNoDepth;
  float depth = kNoDepth;  // along z, meters; kNoDepth if unknown
  int level = 0;           // pyramid level of detection

  static constexpr float kNoDepth = -1;
  bool has_depth() const { return depth > 0; }
  Eigen::Vector2d pixel() const { return {x, y}; }
};

// Grid of kCell-pixel cells over the undistorted image, for finding keypoints near a position in
// constant time.
class KeypointGrid {
 public:
  static constexpr int kCell = 16;  // pixels
  KeypointGrid() = default;
  KeypointGrid(std::span<const Keypoint> keypoints, int width, int height);
  // Calls visit(index) for every keypoint whose cell overlaps the square of half-width `radius`
  // around (x, y), in order of cells, then of indices. The caller must check the exact distance.
  template <typename Visit>
  void VisitNear(float x, float y, float radius, Visit&& visit) const;

 private:
  int columns_ = 0, rows_ = 0;
  float left_ = 0, top_ = 0;  // origin; undistorted keypoints may lie outside the image
  std::vector<int> first_;    // per cell: index into order_; one extra entry at the end
  std::vector<int> order_;    // keypoint indices, grouped by cell
};

// Immutable once complete; shared between tracker, map and workers.
struct Frame {
  double time = 0;  // seconds
  int number = 0;   // index in the recording, from 0
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;  // one per keypoint
  // Probability that each keypoint belongs to a static object, 0 to 1. Empty: no moving objects are
  // known.
  std::vector<float> static_probability;
  KeypointGrid grid;
  cv::Mat image;                 // 8-bit gray, level 0, not undistorted
  std::vector<cv::Mat> pyramid;  // all levels; released when the frame becomes a keyframe
  // Edge thumbnail (Glance() of the image) while a monocular map is being initialized; otherwise
  // empty.
  cv::Mat glance;
  // With a depth image: the smallest depth in each cell of kDepthCell x kDepthCell raw pixels,
  // CV_32F, meters; 0: less than an eighth of the cell has depth. Otherwise empty.
  cv::Mat nearest;
  static constexpr int kDepthCell = 16;
  // Camera motion during the image readout, if known: T_camera_world at s seconds after the middle
  // of the image is Exp(s motion) T_camera_world. Map units and radians per second.
  Vector6d motion = Vector6d::Zero();
  // Input of semi-dense mapping until it is handed over; otherwise null.
  std::shared_ptr<const Picture> picture;

  // Keypoints with a static probability below kUsable are not used for the pose; those below
  // kMappable do not enter the map.
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
