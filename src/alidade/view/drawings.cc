#include "alidade/view/drawings.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "alidade/view/upright.h"

namespace alidade {
namespace {

constexpr double kWidth = 900, kHeight = 620, kMargin = 30;  // pixels
constexpr size_t kMostLandmarks = 8000;

std::string Number(double value, int digits = 1) {
  char text[40];
  std::snprintf(text, sizeof(text), "%.*f", digits, value);
  return text;
}

std::string OpenSvg(double width, double height, const std::string& label) {
  return "<svg viewBox=\"0 0 " + Number(width, 0) + " " + Number(height, 0) +
         "\" role=\"img\" aria-label=\"" + label + "\">\n";
}

std::string Text(double x, double y, const std::string& anchor, const std::string& text) {
  return "<text x=\"" + Number(x) + "\" y=\"" + Number(y) + "\" text-anchor=\"" + anchor + "\">" +
         EscapeHtml(text) + "</text>\n";
}

// From world to page; fits what matters of the place into the picture.
class Page {
 public:
  Page(const PlaceDrawing& place, Eigen::Matrix<double, 2, 3> axes) : axes_(std::move(axes)) {
    std::vector<Eigen::Vector2d> points;
    for (const auto& stretch : place.path) {
      for (const Se3& T : stretch) points.push_back(axes_ * T.t);
    }
    std::vector<double> xs, ys;
    for (const auto& p : place.landmarks) {
      const Eigen::Vector2d q = axes_ * p;
      xs.push_back(q.x());
      ys.push_back(q.y());
    }
    // All of the path, and the landmarks but for the few that lie far off.
    const auto x = Range(std::move(xs)), y = Range(std::move(ys));
    if (!place.landmarks.empty()) {
      points.emplace_back(x[0], y[0]);
      points.emplace_back(x[1], y[1]);
    }
    if (points.empty()) points.emplace_back(0, 0);
    low_ = high_ = points.front();
    for (const auto& p : points) {
      low_ = low_.cwiseMin(p);
      high_ = high_.cwiseMax(p);
    }
    const Eigen::Vector2d size = (high_ - low_).cwiseMax(1e-6);
    scale_ = std::min((kWidth - 2 * kMargin) / size.x(), (kHeight - 2 * kMargin) / size.y());
  }

  double scale() const { return scale_; }  // pixels per unit

  Eigen::Vector2d At(const Eigen::Vector3d& p) const {
    const Eigen::Vector2d from_middle = scale_ * (axes_ * p - 0.5 * (low_ + high_));
    return {kWidth / 2 + from_middle.x(), kHeight / 2 - from_middle.y()};
  }

 private:
  static std::array<double, 2> Range(std::vector<double> values) {
    if (values.empty()) return {0, 0};
    std::sort(values.begin(), values.end());
    const auto rank = [&](double share) {
      return values[static_cast<size_t>(share * static_cast<double>(values.size() - 1))];
    };
    return {rank(0.02), rank(0.98)};
  }

  Eigen::Matrix<double, 2, 3> axes_;
  Eigen::Vector2d low_, high_;
  double scale_ = 1;
};

bool Inside(const Eigen::Vector2d& p) {
  return p.x() >= 0 && p.y() >= 0 && p.x() <= kWidth && p.y() <= kHeight;
}

// Dots are strokes without length: the shortest way to say many.
std::string Dots(const Page& page, const std::vector<Eigen::Vector3d>& points,
                 const std::string& name) {
  const size_t step = 1 + points.size() / kMostLandmarks;
  std::string data;
  for (size_t i = 0; i < points.size(); i += step) {
    const Eigen::Vector2d p = page.At(points[i]);
    if (Inside(p)) data += "M" + Number(p.x()) + " " + Number(p.y()) + "h0";
  }
  return "<path class=\"" + name + "\" d=\"" + data + "\"/>\n";
}

std::string Marker(const Eigen::Vector2d& p, const std::string& name) {
  return "<circle class=\"" + name + "\" cx=\"" + Number(p.x()) + "\" cy=\"" + Number(p.y()) +
         "\" r=\"5\"/>\n";
}

// 1, 2 or 5 times a power of ten, about an eighth of the picture long.
std::string ScaleBar(const Page& page, const std::string& unit) {
  const double wanted = kWidth / 8 / page.scale();
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  const double length = power * (wanted / power >= 5 ? 5 : wanted / power >= 2 ? 2 : 1);
  const double left = 16, right = left + length * page.scale(), y = kHeight - 14;
  char label[64];
  std::snprintf(label, sizeof(label), "%g %s", length, unit.c_str());
  return "<path class=\"scale\" d=\"M" + Number(left) + " " + Number(y) + "H" + Number(right) +
         "\"/>\n" + Text(0.5 * (left + right), y - 6, "middle", label);
}

}  // namespace

std::string EscapeHtml(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string DrawFromAbove(const PlaceDrawing& place) {
  const Page page(place, UprightAxes(place.path).topRows<2>());
  std::string svg = OpenSvg(kWidth, kHeight, "trajectory and landmarks from above");
  svg += Dots(page, place.landmarks, "landmarks");
  for (const auto& stretch : place.path) {
    std::string points;
    for (const Se3& T : stretch) {
      const Eigen::Vector2d p = page.At(T.t);
      points += Number(p.x()) + "," + Number(p.y()) + " ";
    }
    svg += "<polyline class=\"path\" points=\"" + points + "\"/>\n";
  }
  svg += Dots(page, place.keyframes, "keyframes");
  if (!place.path.empty()) {
    svg += Marker(page.At(place.path.front().front().t), "start");
    svg += Marker(page.At(place.path.back().back().t), "end");
    svg += ScaleBar(page, place.unit);
  }
  return svg + "</svg>\n";
}

std::string DrawTimeline(const std::vector<FrameFate>& frames) {
  constexpr double kBar = 18;
  std::string svg = OpenSvg(kWidth, kBar, "what became of each frame");
  const double step = kWidth / static_cast<double>(std::max<size_t>(1, frames.size()));
  for (size_t begin = 0; begin < frames.size();) {
    size_t end = begin;
    while (end < frames.size() && frames[end] == frames[begin]) ++end;
    const char* name = frames[begin] == FrameFate::kTracked ? "tracked"
                       : frames[begin] == FrameFate::kLost  ? "lost"
                                                            : "starting";
    svg += std::string("<rect class=\"") + name + "\" x=\"" +
           Number(static_cast<double>(begin) * step, 2) + "\" y=\"0\" width=\"" +
           Number(static_cast<double>(end - begin) * step, 2) + "\" height=\"" + Number(kBar, 0) +
           "\"/>\n";
    begin = end;
  }
  return svg + "</svg>\n";
}

std::string DrawSeries(const std::vector<double>& values, double top, const std::string& unit) {
  constexpr double kTall = 140, kLeft = 56;
  std::string svg = OpenSvg(kWidth, kTall, unit + " of each frame");
  const auto y = [&](double value) {
    return kTall - 4 - (kTall - 20) * std::min(1.0, value / std::max(top, 1e-9));
  };
  for (const double value : {0.0, top / 2, top}) {
    svg += "<path class=\"grid\" d=\"M" + Number(kLeft) + " " + Number(y(value)) + "H" +
           Number(kWidth) + "\"/>\n";
    svg += Text(kLeft - 6, y(value) + 4, "end", Number(value, top < 10 ? 1 : 0) + " " + unit);
  }
  // Each point of the page shows the largest of the frames that fall on it.
  const size_t columns = std::min<size_t>(values.size(), static_cast<size_t>(kWidth - kLeft));
  std::string points;
  for (size_t c = 0; c < columns; ++c) {
    const size_t begin = c * values.size() / columns, end = (c + 1) * values.size() / columns;
    const double largest = *std::max_element(values.begin() + static_cast<std::ptrdiff_t>(begin),
                                             values.begin() + static_cast<std::ptrdiff_t>(end));
    const double x =
        kLeft + (kWidth - kLeft) * (static_cast<double>(c) + 0.5) / static_cast<double>(columns);
    points += Number(x) + "," + Number(y(largest)) + " ";
  }
  return svg + "<polyline class=\"series\" points=\"" + points + "\"/>\n</svg>\n";
}

}  // namespace alidade
