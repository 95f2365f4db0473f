#include "alidade/view/turnable.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "alidade/view/svg.h"
#include "alidade/view/turnable_script.h"
#include "alidade/view/upright.h"

namespace alidade {
namespace {

struct Box {
  Eigen::Vector3f low, high;
  bool Has(const Eigen::Vector3f& p) const {
    return (p.array() >= low.array()).all() && (p.array() <= high.array()).all();
  }
};

// Box of all points except the outermost 2 % along each axis, enlarged by half, and of all of the
// path.
Box BoxOf(const std::vector<Eigen::Vector3f>& points, const std::vector<Eigen::Vector3f>& path) {
  constexpr double kLeftOut = 0.02;
  constexpr float kRoomAround = 0.25f;  // share of the extent, added on either side
  Box box{Eigen::Vector3f::Constant(INFINITY), Eigen::Vector3f::Constant(-INFINITY)};
  std::vector<float> along(points.size());
  for (int axis = 0; axis < 3 && !points.empty(); ++axis) {
    for (size_t i = 0; i < points.size(); ++i) along[i] = points[i][axis];
    std::sort(along.begin(), along.end());
    const auto last = static_cast<double>(along.size() - 1);
    const float low = along[static_cast<size_t>(kLeftOut * last)];
    const float high = along[static_cast<size_t>((1 - kLeftOut) * last)];
    box.low[axis] = low - kRoomAround * (high - low);
    box.high[axis] = high + kRoomAround * (high - low);
  }
  for (const Eigen::Vector3f& p : path) {
    box.low = box.low.cwiseMin(p);
    box.high = box.high.cwiseMax(p);
  }
  return box;
}

// Little endian, as on all platforms with browsers.
void AppendUint16(std::string& bytes, uint16_t value) {
  bytes.push_back(static_cast<char>(value & 255));
  bytes.push_back(static_cast<char>(value >> 8));
}

// Data for the script.
struct Packed {
  std::string bytes;      // points, then path: x, y, z with 16 bits each; then the points' colors
  size_t points = 0;      // number of points
  std::string stretches;  // number of poses of each stretch of the path
  bool colored = false;
  float extent = 0;  // length of the script's unit, in units of the scene
};

Packed Pack(const CloudScene& scene) {
  const Eigen::Matrix3f axes =
      UprightAxes(scene.path, scene.gravity).cast<float>();  // rows: right, forward, up
  std::vector<Eigen::Vector3f> points, path;
  for (const Eigen::Vector3f& p : scene.cloud.points) points.emplace_back(axes * p);
  Packed packed;
  for (const auto& stretch : scene.path) {
    for (const Se3& T : stretch) path.emplace_back(axes * T.t.cast<float>());
    packed.stretches += (packed.stretches.empty() ? "" : " ") + std::to_string(stretch.size());
  }
  const Box box = BoxOf(points, path);
  const float extent = (box.high - box.low).maxCoeff();
  if (!(extent > 0) || !std::isfinite(extent)) return {};
  std::vector<size_t> kept;
  for (size_t i = 0; i < points.size(); ++i) {
    const bool known = scene.cloud.sigmas.empty() || scene.cloud.sigmas[i] < 0.01f * extent;
    if (known && box.Has(points[i])) kept.push_back(i);
  }
  packed.points = std::min(kept.size(), kMostTurnablePoints);
  packed.extent = extent;
  packed.colored = !scene.cloud.colors.empty();
  const auto append = [&](const Eigen::Vector3f& p) {
    // centered along the axes that are shorter than the longest one
    const Eigen::Vector3f at =
        (p - 0.5f * (box.low + box.high)) / extent + Eigen::Vector3f::Constant(0.5f);
    for (int axis = 0; axis < 3; ++axis)
      AppendUint16(packed.bytes,
                   static_cast<uint16_t>(std::lround(65535 * std::clamp(at[axis], 0.0f, 1.0f))));
  };
  const auto chosen = [&](size_t i) { return kept[i * kept.size() / packed.points]; };
  for (size_t i = 0; i < packed.points; ++i) append(points[chosen(i)]);
  for (const Eigen::Vector3f& p : path) append(p);
  for (size_t i = 0; packed.colored && i < packed.points; ++i) {
    for (const uint8_t part : scene.cloud.colors[chosen(i)])
      packed.bytes.push_back(static_cast<char>(part));
  }
  return packed;
}

}  // namespace

std::string PictureHtml(const ReportPicture& picture) {
  const std::string caption = EscapeHtml(picture.caption);
  return "<img alt=\"" + caption + "\" src=\"data:" + picture.type + ";base64," +
         Base64(picture.bytes) + "\">";
}

std::string TurnableHtml(const CloudScene& scene, const ReportPicture& picture,
                         const std::string& unit) {
  const Packed packed = Pack(scene);
  std::string html = "<figure class=\"turn\" id=\"turn\">\n";
  if (!picture.bytes.empty()) html += PictureHtml(picture) + "\n";
  if (packed.points == 0) return html + "</figure>\n";
  html +=
      "<canvas tabindex=\"0\" role=\"application\" aria-label=\"the map; arrow keys rotate, plus "
      "and minus zoom\"></canvas>\n<span class=\"live measure\" "
      "id=\"turn-scale\"></span>\n<figcaption><span class=\"still\">" +
      EscapeHtml(picture.caption) +
      "</span><span class=\"live\"><button type=\"button\" data-view=\"behind\">From behind"
      "</button> <button type=\"button\" data-view=\"above\">From above</button> "
      "<button type=\"button\" data-view=\"side\">From the side</button> "
      "Drag or arrow keys turn; pinch, or + and −, go nearer; with Shift it moves.</span>"
      "</figcaption>\n</figure>\n";
  html += "<script type=\"text/plain\" id=\"turn-points\" data-points=\"" +
          std::to_string(packed.points) + "\" data-path=\"" + packed.stretches +
          "\" data-colored=\"" + (packed.colored ? "1" : "0") + "\" data-extent=\"" +
          SvgNumber(packed.extent, 6) + "\" data-unit=\"" + EscapeHtml(unit) + "\">" +
          Base64(packed.bytes) + "</script>\n";
  return html + "<script>" + kTurnableScript + "</script>\n";
}

}  // namespace alidade
