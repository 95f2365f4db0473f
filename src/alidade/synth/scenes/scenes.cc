#include "alidade/synth/scenes/scenes.h"

#include <cmath>
#include <numbers>

#include "alidade/synth/settings.h"

namespace alidade {

Layout LayOut(const std::string& name, SceneBuilder& builder) {
  SceneFrames(name);  // throws on an unknown name
  if (name == "desk") return LayOutDesk(builder);
  if (name == "corridor") return LayOutCorridor(builder);
  if (name == "wall") return LayOutWall(builder);
  if (name == "loop") return LayOutLoop(builder);
  if (name == "street") return LayOutStreet(builder);
  if (name == "road") return LayOutRoad(builder);
  if (name == "table") return LayOutTable(builder);
  if (name == "blank") return LayOutBlank(builder);
  if (name == "hall") return LayOutHall(builder);
  return LayOutRoom(builder);
}

Layout TurnOnTheSpot(Layout layout, double arm) {
  const PathKnot begin = layout.knots.front();
  constexpr int kKnots = 48;
  layout.knots.clear();
  for (int i = 0; i < kKnots; ++i) {
    const double angle = 2 * std::numbers::pi * i / kKnots;
    PathKnot knot = begin;
    knot.yaw += angle + 0.25 * std::sin(3 * angle);  // varying speed
    knot.pitch += 0.08 * std::sin(5 * angle);
    knot.position += arm * Eigen::Vector3d(std::cos(knot.yaw), std::sin(knot.yaw), 0);
    layout.knots.push_back(knot);
  }
  layout.period = 16;  // 22 degrees/s
  layout.turns = 1;
  layout.shake.position = 0;
  return layout;
}

Layout StandStill(Layout layout) {
  const PathKnot begin = layout.knots.front();
  layout.knots.assign(4, begin);
  layout.turns = 0;
  layout.shake.position = layout.shake.rotation = 0;
  return layout;
}

std::vector<PathKnot> KnotsAlong(const std::vector<Eigen::Vector2d>& corners, double height,
                                 int count) {
  std::vector<double> until = {0};
  for (size_t i = 0; i < corners.size(); ++i) {
    until.push_back(until.back() + (corners[(i + 1) % corners.size()] - corners[i]).norm());
  }
  const auto at = [&](double s) -> Eigen::Vector2d {
    s -= std::floor(s / until.back()) * until.back();
    size_t i = 0;
    while (i + 2 < until.size() && until[i + 1] < s) ++i;
    const double share = (s - until[i]) / (until[i + 1] - until[i]);
    return corners[i] + share * (corners[(i + 1) % corners.size()] - corners[i]);
  };
  std::vector<PathKnot> knots;
  double last = 0;
  for (int i = 0; i < count; ++i) {
    const double s = until.back() * i / count;
    const Eigen::Vector2d p = at(s), ahead = at(s + 1.2) - at(s - 0.4);
    double yaw = std::atan2(ahead.y(), ahead.x());
    if (i > 0) yaw = last + std::remainder(yaw - last, 2 * std::numbers::pi);
    last = yaw;
    knots.push_back({{p.x(), p.y(), height}, yaw, 0});
  }
  return knots;
}

}  // namespace alidade
