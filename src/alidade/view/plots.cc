#include "alidade/view/plots.h"

#include <algorithm>
#include <cmath>

#include "alidade/base/print.h"
#include "alidade/view/svg.h"

namespace alidade {
namespace {

constexpr size_t kColours = 6;
constexpr double kRow = 46, kBar = 18;  // of named bars, pixels

const char* NameOf(FrameFate fate) {
  return fate == FrameFate::kTracked ? "tracked" : fate == FrameFate::kLost ? "lost" : "starting";
}

std::string Bar(double left, double right, double y, const std::string& name) {
  return "<rect class=\"" + name + "\" x=\"" + SvgNumber(left, 2) + "\" y=\"" + SvgNumber(y) +
         "\" width=\"" + SvgNumber(std::max(0.0, right - left), 2) + "\" height=\"" +
         SvgNumber(kBar, 0) + "\"/>\n";
}

std::string Short(double value, const std::string& unit) {
  char text[64];
  PrintTo(text, sizeof(text), "%.4g", value);
  return unit.empty() ? text : text + (" " + unit);
}

// Time axis with ticks below a drawing of height `y`.
std::string TimeAxis(double x_end, double y, const std::string& unit) {
  std::string svg;
  const double step = RoundStep(x_end / 4);
  for (int i = 0; i * step <= x_end * (1 + 1e-9) && i < 20; ++i) {
    const double x = kPictureWidth * i * step / x_end;
    svg += "<path class=\"grid\" d=\"M" + SvgNumber(x) + " " + SvgNumber(y) + "v6\"/>\n";
    svg += SvgText(x, y + 26,
                   i == 0                   ? "start"
                   : x > kPictureWidth - 40 ? "end"
                                            : "middle",
                   Short(i * step, unit));
  }
  return svg;
}

}  // namespace

std::string ClassOfRun(size_t number) {
  return "run" + std::to_string(number % kColours) + (number / kColours % 2 == 1 ? " again" : "");
}

std::string DrawPaths(const std::vector<DrawnPath>& paths, const DrawnPath& truth, PlaceView view,
                      const std::string& unit) {
  const auto first =
      std::find_if(paths.begin(), paths.end(), [](const DrawnPath& path) { return !path.empty(); });
  std::vector<DrawnPath> all = paths;
  all.push_back(truth);
  const PlacePage page(all, {}, first == paths.end() ? truth : *first, view);
  std::string svg =
      OpenSvg(kPictureWidth, page.height(),
              std::string("paths from ") + (view == PlaceView::kAbove ? "above" : "the side"));
  svg += page.Lines(truth, "truth");
  for (size_t i = 0; i < paths.size(); ++i) svg += page.Lines(paths[i], "curve " + ClassOfRun(i));
  for (const DrawnPath& path : paths) {
    if (path.empty()) continue;
    svg += page.Marker(path.front().front().t, "start");
    svg += page.Marker(path.back().back().t, "end");
  }
  if (first != paths.end()) svg += page.ScaleBar(unit);
  return svg + "</svg>\n";
}

std::string DrawCurves(const std::vector<Curve>& curves, double x_end, const std::string& x_unit,
                       const std::string& y_unit, const std::string& label) {
  constexpr double kTall = 260, kFoot = 34;
  double top = 0;
  for (const Curve& curve : curves) {
    for (const auto& stretch : curve) {
      for (const auto& point : stretch) top = std::max(top, point.y());
    }
  }
  const double step = RoundStep(std::max(top, 1e-9) / 2);
  top = step * std::ceil(std::max(top, 1e-9) / step);
  x_end = std::max(x_end, 1e-9);
  const double bottom = kTall - kFoot;
  const auto y = [&](double value) { return bottom - (bottom - 26) * value / top; };
  std::string svg = OpenSvg(kPictureWidth, kTall, label), words;
  for (int i = 0; i * step <= top * (1 + 1e-9); ++i) {
    const double at = y(i * step);
    svg += "<path class=\"grid\" d=\"M0 " + SvgNumber(at) + "H" + SvgNumber(kPictureWidth, 0) +
           "\"/>\n";
    if (i > 0) words += SvgText(2, at - 4, "start", Short(i * step, y_unit));
  }
  for (size_t i = 0; i < curves.size(); ++i) {
    for (const auto& stretch : curves[i]) {
      std::string points;
      Eigen::Vector2d last(-10, -10);
      for (const auto& point : stretch) {
        const Eigen::Vector2d at(kPictureWidth * point.x() / x_end, y(point.y()));
        if ((at - last).cwiseAbs().maxCoeff() < 0.5) continue;  // less than half a pixel
        points += SvgNumber(at.x()) + "," + SvgNumber(at.y()) + " ";
        last = at;
      }
      svg += "<polyline class=\"curve " + ClassOfRun(i) + "\" points=\"" + points + "\"/>\n";
    }
  }
  return svg + words + TimeAxis(x_end, bottom, x_unit) + "</svg>\n";
}

std::string DrawSpans(const std::vector<std::string>& names,
                      const std::vector<std::vector<FateSpan>>& runs, double x_end) {
  x_end = std::max(x_end, 1e-9);
  const double bottom = kRow * static_cast<double>(runs.size());
  std::string svg = OpenSvg(kPictureWidth, bottom + 34, "state of each run's frames");
  for (size_t i = 0; i < runs.size(); ++i) {
    const double y = kRow * static_cast<double>(i) + 24;
    svg += SvgText(0, y - 5, "start", names[i]);
    for (const FateSpan& span : runs[i]) {
      const auto x = [&](double seconds) {
        return kPictureWidth * std::clamp(seconds / x_end, 0.0, 1.0);
      };
      svg += Bar(x(span.begin), x(span.end), y, NameOf(span.fate));
    }
  }
  return svg + TimeAxis(x_end, bottom, "s") + "</svg>\n";
}

std::string DrawMedians(const std::vector<std::string>& names, const std::vector<MedianBar>& bars,
                        const std::string& unit) {
  double top = 1e-9;
  for (const MedianBar& bar : bars) top = std::max({top, bar.median, bar.p95});
  std::string svg = OpenSvg(kPictureWidth, kRow * static_cast<double>(bars.size()) + 4,
                            "median and 95th percentile of each run");
  for (size_t i = 0; i < bars.size(); ++i) {
    const MedianBar& bar = bars[i];
    const double y = kRow * static_cast<double>(i) + 24;
    const auto x = [&](double value) { return kPictureWidth * value / top; };
    if (bar.median < 0) {
      svg += SvgText(0, y - 5, "start", names[i] + ": did not run");
      continue;
    }
    const std::string own = ClassOfRun(i);
    svg += Bar(x(bar.median), x(bar.p95), y, "rest " + own);
    svg += Bar(0, x(bar.median), y, "half " + own);
    svg += SvgText(0, y - 5, "start",
                   names[i] + ": " + Short(bar.median, unit) + ", 95 % below " +
                       Short(bar.p95, unit) + ", largest " + Short(bar.max, unit));
  }
  return svg + "</svg>\n";
}

}  // namespace alidade
