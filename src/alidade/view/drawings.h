// Pictures of a run as SVG elements, drawn with CSS classes that the page gives its colours.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "alidade/geometry/se3.h"

namespace alidade {

// What is drawn of a place. All in one world frame and unit.
struct PlaceDrawing {
  std::vector<std::vector<Se3>> path;  // T_world_camera; one list for each stretch without a gap
  std::vector<Eigen::Vector3d> keyframes, landmarks;
  std::string unit;  // of the scale bar, e.g. "m"
};

// Seen from above: cameras are held upright on average, so up is the mean of their up directions;
// where the first camera looked is up on the page. Far-off landmarks are left out; at most some
// thousands are drawn.
std::string DrawFromAbove(const PlaceDrawing& place);

// What became of each frame, along time: one bar.
enum class FrameFate { kStarting, kTracked, kLost };
std::string DrawTimeline(const std::vector<FrameFate>& frames);

// One value per frame, e.g. milliseconds, as a line over the frames; the axis ends at `top`.
std::string DrawSeries(const std::vector<double>& values, double top, const std::string& unit);

std::string EscapeHtml(const std::string& text);

}  // namespace alidade
