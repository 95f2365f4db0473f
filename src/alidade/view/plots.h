// Plots of several runs as SVG elements. Each run has a color by its number, from the seventh on
// with a dashed line (page.h defines the colors).
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "alidade/view/drawings.h"
#include "alidade/view/place_page.h"

namespace alidade {

std::string ClassOfRun(size_t number);

// Draws the paths over each other, in one world; the first non-empty path defines up. `truth` may
// be empty.
std::string DrawPaths(const std::vector<DrawnPath>& paths, const DrawnPath& truth, PlaceView view,
                      const std::string& unit);

// Points (x, y), one list per uninterrupted stretch. DrawCurves() takes one curve per run, possibly
// empty.
using Curve = std::vector<std::vector<Eigen::Vector2d>>;
std::string DrawCurves(const std::vector<Curve>& curves, double x_end, const std::string& x_unit,
                       const std::string& y_unit, const std::string& label);

// Consecutive frames with the same state, from `begin` to `end` seconds.
struct FateSpan {
  double begin = 0, end = 0;
  FrameFate fate = FrameFate::kTracked;
};
// One named bar per run, one below the other.
std::string DrawSpans(const std::vector<std::string>& names,
                      const std::vector<std::vector<FateSpan>>& runs, double x_end);

// One named bar per run up to the median, a lighter one to the 95th percentile, and the numbers.
// The axis ends at the largest 95th percentile. A negative median: no data.
struct MedianBar {
  double median = -1, p95 = 0, max = 0;
};
std::string DrawMedians(const std::vector<std::string>& names, const std::vector<MedianBar>& bars,
                        const std::string& unit);

}  // namespace alidade
