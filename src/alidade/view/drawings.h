// Drawings of a run as SVG elements; the page's CSS classes define their colors.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "alidade/view/place_page.h"

namespace alidade {

// Data to draw of a place, in one world frame and unit.
struct PlaceDrawing {
  DrawnPath path;
  std::vector<Eigen::Vector3d> keyframes, landmarks;
  std::string unit;      // of the scale bar, for example "m"
  DrawnPath truth = {};  // ground truth; empty: unknown
  std::optional<Eigen::Vector3d> gravity =
      {};  // unit vector in which things fall; nullopt: unknown
};

// Up is against gravity, or estimated from the camera path (UprightAxes()). Distant landmarks are
// omitted, and at most a few thousand are drawn.
std::string DrawPlace(const PlaceDrawing& place, PlaceView view);

// The state of each frame along time, as one bar.
enum class FrameFate { kStarting, kTracked, kLost };
std::string DrawTimeline(const std::vector<FrameFate>& frames);

// One value per frame, for example milliseconds, as a line over the frames; the axis ends at `top`.
std::string DrawSeries(const std::vector<double>& values, double top, const std::string& unit);

}  // namespace alidade
