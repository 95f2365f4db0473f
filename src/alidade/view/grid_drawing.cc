#include "alidade/view/grid_drawing.h"

#include <algorithm>

#include "alidade/view/report.h"
#include "alidade/view/svg.h"

namespace alidade {
namespace {

constexpr double kMostTall = 900;  // units of the drawing

std::string EndDot(const Eigen::Vector2d& at, const char* name) {
  return std::string("<circle class=\"") + name + "\" cx=\"" + SvgNumber(at.x()) + "\" cy=\"" +
         SvgNumber(at.y()) + "\" r=\"6\"/>\n";
}

}  // namespace

std::string DrawGrid(const GridDrawing& grid) {
  Eigen::Vector2d low(grid.x, grid.y),
      high = low + grid.cell * Eigen::Vector2d(grid.width, grid.height);
  for (const Eigen::Vector2d& p : grid.path) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Eigen::Vector2d size = high - low + Eigen::Vector2d::Constant(2 * grid.cell);
  const double scale = std::min(kPictureWidth / size.x(), kMostTall / size.y()),
               tall = scale * size.y();
  const auto at = [&](const Eigen::Vector2d& p) {
    const Eigen::Vector2d from_middle = scale * (p - 0.5 * (low + high));
    return Eigen::Vector2d(kPictureWidth / 2 + from_middle.x(), tall / 2 - from_middle.y());
  };
  std::string svg = OpenSvg(kPictureWidth, tall, "floor grid and path from above");
  svg += "<rect width=\"100%\" height=\"100%\" fill=\"#cdcdcd\"/>\n";  // unknown
  const Eigen::Vector2d corner = at({grid.x, grid.y + grid.cell * grid.height});
  svg += "<image href=\"data:image/png;base64," + Base64(grid.png) + "\" x=\"" +
         SvgNumber(corner.x()) + "\" y=\"" + SvgNumber(corner.y()) + "\" width=\"" +
         SvgNumber(scale * grid.cell * grid.width) + "\" height=\"" +
         SvgNumber(scale * grid.cell * grid.height) +
         "\" preserveAspectRatio=\"none\" style=\"image-rendering:pixelated\"/>\n";
  std::string points;
  for (const Eigen::Vector2d& p : grid.path)
    points += SvgNumber(at(p).x()) + "," + SvgNumber(at(p).y()) + " ";
  if (!grid.path.empty()) {
    svg += "<polyline points=\"" + points + "\" style=\"stroke:#0b6fd1;stroke-width:3\"/>\n";
    svg += EndDot(at(grid.path.front()), "start") + EndDot(at(grid.path.back()), "end");
  }
  // Dark on the gray of unknown cells, whatever the colors of the page.
  return svg + "<g style=\"--soft:#1b1f24;--page:#cdcdcd\">" + SvgScaleBar(scale, tall, grid.unit) +
         "</g></svg>\n";
}

}  // namespace alidade
