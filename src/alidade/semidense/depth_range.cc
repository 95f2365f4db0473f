#include "alidade/semidense/depth_range.h"

#include <algorithm>
#include <cmath>

#include "alidade/semidense/pixel_transfer.h"

namespace alidade {
namespace {

// Cells of DepthRange per cell of the landmark grid, along each axis.
constexpr int kLandmarkCells = 4;
constexpr int kEnoughLandmarks = 4;  // needed nearby for a local range
constexpr int kEnoughDepth = 12;     // pixels with depth needed nearby for a local range
// Relative margin added to a local range on both sides.
constexpr float kMargin = 0.12f;

// Range of inverse depths in a cell.
struct Span {
  float min = 1e30f, max = 0;
  int count = 0;
  void Add(float inverse_depth) {
    min = std::min(min, inverse_depth);
    max = std::max(max, inverse_depth);
    ++count;
  }
  void Add(const Span& other) {
    min = std::min(min, other.min);
    max = std::max(max, other.max);
    count += other.count;
  }
  DepthInterval Widened() const { return {min * (1 - kMargin), max * (1 + kMargin)}; }
};

// Grid of ranges, queried with the eight neighboring cells.
class SpanGrid {
 public:
  SpanGrid(int columns, int rows) : columns_(columns), rows_(rows), spans_(columns * rows) {}
  Span& At(int column, int row) {
    column = std::clamp(column, 0, columns_ - 1);
    return spans_[std::clamp(row, 0, rows_ - 1) * columns_ + column];
  }
  Span Around(int column, int row) const {
    Span all;
    for (int r = std::max(0, row - 1); r <= std::min(rows_ - 1, row + 1); ++r) {
      for (int c = std::max(0, column - 1); c <= std::min(columns_ - 1, column + 1); ++c) {
        all.Add(spans_[r * columns_ + c]);
      }
    }
    return all;
  }

 private:
  int columns_, rows_;
  std::vector<Span> spans_;
};

}  // namespace

DepthRange::DepthRange(const MapSnapshot& map, const KeyFrame& keyframe, const Camera& camera,
                       std::span<const DepthView> views) {
  columns_ = (camera.width + kCell - 1) / kCell;
  rows_ = (camera.height + kCell - 1) / kCell;
  cells_.resize(columns_ * rows_);
  SpanLandmarks(map, keyframe);
  if (known()) SpanViews(camera, views);
}

void DepthRange::SpanLandmarks(const MapSnapshot& map, const KeyFrame& keyframe) {
  constexpr int kWide = kCell * kLandmarkCells;  // pixels
  SpanGrid grid(columns_ / kLandmarkCells + 1, rows_ / kLandmarkCells + 1);
  double sum = 0, squares = 0;
  int count = 0;
  for (size_t i = 0; i < keyframe.landmarks.size(); ++i) {
    const Landmark* landmark =
        keyframe.landmarks[i].valid() ? map.Find(keyframe.landmarks[i]) : nullptr;
    if (!landmark) continue;
    const double z = (keyframe.T_camera_world * landmark->p_world).z();
    if (z <= 0) continue;
    sum += 1 / z;
    squares += 1 / (z * z);
    ++count;
    const Keypoint& keypoint = keyframe.frame->keypoints[i];
    grid.At(static_cast<int>(keypoint.x) / kWide, static_cast<int>(keypoint.y) / kWide)
        .Add(static_cast<float>(1 / z));
  }
  if (count < kEnoughLandmarks) return;
  const double mean = sum / count;
  const double sigma = std::sqrt(std::max(0.0, squares / count - mean * mean));
  Span all;
  all.Add(static_cast<float>(std::max(0.0, mean - 2 * sigma)));
  all.Add(static_cast<float>(mean + 2 * sigma));
  all_ = all.Widened();
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const Span near = grid.Around(column / kLandmarkCells, row / kLandmarkCells);
      cells_[row * columns_ + column] = near.count < kEnoughLandmarks ? all_ : near.Widened();
    }
  }
}

void DepthRange::SpanViews(const Camera& camera, std::span<const DepthView> views) {
  SpanGrid grid(columns_, rows_);
  for (const DepthView& view : views) {
    const PixelTransfer from_view(camera, view.T_view_reference.Inverse());
    for (size_t i = 0; i < view.edges.size(); ++i) {
      if (!view.depth[i].known()) continue;
      const float inverse = view.depth[i].inverse_depth;
      const Eigen::Vector3f p =
          from_view.at_infinity * Eigen::Vector3f(view.edges[i].x, view.edges[i].y, 1) +
          inverse * from_view.shift;
      if (p.z() < 0.05f) continue;
      const float x = p.x() / p.z(), y = p.y() / p.z();
      if (!(x >= 0 && y >= 0 && x < static_cast<float>(camera.width) &&
            y < static_cast<float>(camera.height)))
        continue;
      grid.At(static_cast<int>(x) / kCell, static_cast<int>(y) / kCell).Add(inverse / p.z());
    }
  }
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const Span near = grid.Around(column, row);
      if (near.count >= kEnoughDepth) cells_[row * columns_ + column] = near.Widened();
    }
  }
}

}  // namespace alidade
