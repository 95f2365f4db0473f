// Pictures of a run as SVG elements, drawn with CSS classes that the page gives its colours.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "alidade/view/place_page.h"

namespace alidade {

// What is drawn of a place. All in one world frame and unit.
struct PlaceDrawing {
  DrawnPath path;
  std::vector<Eigen::Vector3d> keyframes, landmarks;
  std::string unit;      // of the scale bar, e.g. "m"
  DrawnPath truth = {};  // where it is known
};

// Cameras are held upright on average, so up is the mean of their up directions. Far-off landmarks
// are left out; at most some thousands are drawn.
std::string DrawPlace(const PlaceDrawing& place, PlaceView view);

// What became of each frame, along time: one bar.
enum class FrameFate { kStarting, kTracked, kLost };
std::string DrawTimeline(const std::vector<FrameFate>& frames);

// One value per frame, e.g. milliseconds, as a line over the frames; the axis ends at `top`.
std::string DrawSeries(const std::vector<double>& values, double top, const std::string& unit);

}  // namespace alidade
