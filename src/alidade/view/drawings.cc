#include "alidade/view/drawings.h"

#include <algorithm>

#include "alidade/view/svg.h"

namespace alidade {

std::string DrawPlace(const PlaceDrawing& place, PlaceView view) {
  const PlacePage page({place.path, place.truth}, place.landmarks, place.path, view, place.gravity);
  std::string svg = OpenSvg(kPictureWidth, page.height(),
                            std::string("trajectory and landmarks from ") +
                                (view == PlaceView::kAbove ? "above" : "the side"));
  svg += page.Dots(place.landmarks, "landmarks");
  svg += page.Lines(place.truth, "truth");
  svg += page.Lines(place.path, "path");
  svg += page.Dots(place.keyframes, "keyframes");
  if (!place.path.empty()) {
    svg += page.Marker(place.path.front().front().t, "start");
    svg += page.Marker(place.path.back().back().t, "end");
    svg += page.ScaleBar(place.unit);
  }
  return svg + "</svg>\n";
}

std::string DrawTimeline(const std::vector<FrameFate>& frames) {
  constexpr double kBar = 18;
  std::string svg = OpenSvg(kPictureWidth, kBar, "state of each frame");
  const double step = kPictureWidth / static_cast<double>(std::max<size_t>(1, frames.size()));
  for (size_t begin = 0; begin < frames.size();) {
    size_t end = begin;
    while (end < frames.size() && frames[end] == frames[begin]) ++end;
    const char* name = frames[begin] == FrameFate::kTracked ? "tracked"
                       : frames[begin] == FrameFate::kLost  ? "lost"
                                                            : "starting";
    svg += std::string("<rect class=\"") + name + "\" x=\"" +
           SvgNumber(static_cast<double>(begin) * step, 2) + "\" y=\"0\" width=\"" +
           SvgNumber(static_cast<double>(end - begin) * step, 2) + "\" height=\"" +
           SvgNumber(kBar, 0) + "\"/>\n";
    begin = end;
  }
  return svg + "</svg>\n";
}

std::string DrawSeries(const std::vector<double>& values, double top, const std::string& unit) {
  constexpr double kTall = 140, kLeft = 56;
  std::string svg = OpenSvg(kPictureWidth, kTall, unit + " of each frame");
  const auto y = [&](double value) {
    return kTall - 4 - (kTall - 20) * std::min(1.0, value / std::max(top, 1e-9));
  };
  for (const double value : {0.0, top / 2, top}) {
    svg += "<path class=\"grid\" d=\"M" + SvgNumber(kLeft) + " " + SvgNumber(y(value)) + "H" +
           SvgNumber(kPictureWidth) + "\"/>\n";
    svg += SvgText(kLeft - 6, y(value) + 4, "end", SvgNumber(value, top < 10 ? 1 : 0) + " " + unit);
  }
  // Each horizontal unit shows the maximum of its frames.
  const size_t columns =
      std::min<size_t>(values.size(), static_cast<size_t>(kPictureWidth - kLeft));
  std::string points;
  for (size_t c = 0; c < columns; ++c) {
    const size_t begin = c * values.size() / columns, end = (c + 1) * values.size() / columns;
    const double largest = *std::max_element(values.begin() + static_cast<std::ptrdiff_t>(begin),
                                             values.begin() + static_cast<std::ptrdiff_t>(end));
    const double x = kLeft + (kPictureWidth - kLeft) * (static_cast<double>(c) + 0.5) /
                                 static_cast<double>(columns);
    points += SvgNumber(x) + "," + SvgNumber(y(largest)) + " ";
  }
  return svg + "<polyline class=\"series\" points=\"" + points + "\"/>\n</svg>\n";
}

}  // namespace alidade
