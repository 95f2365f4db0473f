// Several runs in one drawing: each has a colour by its number, and from the seventh on a dashed
// line with it. As SVG elements (page.h has the colours).
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "alidade/view/drawings.h"
#include "alidade/view/place_page.h"

namespace alidade {

std::string ClassOfRun(size_t number);

// Over each other, in one world; the first path that is not empty says which way is up. `truth` may
// be empty.
std::string DrawPaths(const std::vector<DrawnPath>& paths, const DrawnPath& truth, PlaceView view,
                      const std::string& unit);

// Points (x, y), one list for each stretch without a gap; one element for each run, perhaps empty.
using Curve = std::vector<std::vector<Eigen::Vector2d>>;
std::string DrawCurves(const std::vector<Curve>& curves, double x_end, const std::string& x_unit,
                       const std::string& y_unit, const std::string& label);

// What became of a recording's frames, from `begin` to `end` seconds.
struct FateSpan {
  double begin = 0, end = 0;
  FrameFate fate = FrameFate::kTracked;
};
// A bar for each run, one under the other, named.
std::string DrawSpans(const std::vector<std::string>& names,
                      const std::vector<std::vector<FateSpan>>& runs, double x_end);

// For each run, named: a bar to the median, a lighter one to p95 and the figures; the axis ends
// with the largest p95. A median below 0: there is none.
struct MedianBar {
  double median = -1, p95 = 0, max = 0;
};
std::string DrawMedians(const std::vector<std::string>& names, const std::vector<MedianBar>& bars,
                        const std::string& unit);

}  // namespace alidade
