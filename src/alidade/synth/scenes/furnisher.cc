// Primitives of furniture, and walls, floors and ceilings.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "alidade/synth/scenes/furniture.h"

namespace alidade {

using Eigen::Vector2d;
using Eigen::Vector3d;

Vector3d Place::Direction(double x, double y, double z) const {
  const double c = std::cos(yaw), s = std::sin(yaw);
  return {c * x - s * y, s * x + c * y, z};
}
Vector3d Place::Point(double x, double y, double z) const { return origin + Direction(x, y, z); }

namespace {

cv::Size Texels(double width, double height, double density) {
  return {std::max(2, static_cast<int>(std::lround(width * density))),
          std::max(2, static_cast<int>(std::lround(height * density)))};
}

}  // namespace

int Furnisher::Picture(SizedPainter paint, double width, double height, double scale) {
  const cv::Size size = Texels(width, height, density_ * scale);
  return builder_.Paint([=](Random& random) { return paint(random, size); });
}

int Furnisher::Material(ToneFn paint, double width, double height, double tone, double scale) {
  const double density = density_ * scale;
  const cv::Size size = Texels(width, height, density);
  return builder_.Paint([=](Random& random) { return paint(random, size, density, tone); });
}

void Furnisher::Box(const Place& place, const Vector3d& corner, const Vector3d& size,
                    const BoxFaces& faces) {
  const Vector3d a = corner, b = corner + size;
  const auto face = [&](int texture, const Vector3d& origin, const Vector3d& right,
                        const Vector3d& down) {
    if (texture < 0) return;
    Rect rect;
    rect.origin = place.Point(origin.x(), origin.y(), origin.z());
    rect.right = place.Direction(right.x(), right.y(), right.z());
    rect.down = place.Direction(down.x(), down.y(), down.z());
    rect.texture = texture;
    builder_.Add(std::move(rect));
  };
  const Vector3d down(0, 0, -size.z());
  face(faces.front, {a.x(), a.y(), b.z()}, {size.x(), 0, 0}, down);
  face(faces.back, {b.x(), b.y(), b.z()}, {-size.x(), 0, 0}, down);
  face(faces.left, {a.x(), b.y(), b.z()}, {0, -size.y(), 0}, down);
  face(faces.right, {b.x(), a.y(), b.z()}, {0, size.y(), 0}, down);
  face(faces.top, {a.x(), b.y(), b.z()}, {size.x(), 0, 0}, {0, -size.y(), 0});
  face(faces.bottom, {a.x(), a.y(), a.z()}, {size.x(), 0, 0}, {0, size.y(), 0});
}

void Furnisher::WoodBox(const Place& place, const Vector3d& corner, const Vector3d& size,
                        double tone) {
  BoxFaces faces;
  faces.front = faces.back = Material(PaintWood, size.x(), size.z(), tone);
  faces.left = faces.right = Material(PaintWood, size.y(), size.z(), tone);
  faces.top = Material(PaintWood, size.x(), size.y(), tone);
  faces.bottom = builder_.Tone(tone);
  Box(place, corner, size, faces);
}

void Furnisher::Shade(const Place& place, const Vector3d& corner, const Vector3d& size) {
  const Vector3d middle = corner + size / 2;
  builder_.AddObstacle({place.Point(middle.x(), middle.y(), middle.z()), size / 2,
                        std::cos(place.yaw), std::sin(place.yaw)});
}

void Furnisher::Round(const Place& place, double x, double y, double z, double height, double foot,
                      double rim, int texture) {
  Quadric round;
  round.kind = Quadric::Kind::kFrustum;
  round.origin = place.Point(x, y, z);
  Eigen::Matrix3d axes;
  axes.row(0) = place.Direction(1, 0, 0).transpose() / foot;
  axes.row(1) = place.Direction(0, 1, 0).transpose() / foot;
  axes.row(2) = Vector3d(0, 0, 1 / height).transpose();
  round.from_world = axes;
  round.top = rim / foot;
  round.centre = round.origin + Vector3d(0, 0, height / 2);
  round.radius = std::hypot(height / 2, std::max(foot, rim));
  round.size = 2 * std::numbers::pi * std::max(foot, rim);
  round.texture = texture;
  builder_.Add(round);
}

void Furnisher::Ball(const Place& place, double x, double y, double z, const Vector3d& radii,
                     int texture) {
  Quadric ball;
  ball.origin = ball.centre = place.Point(x, y, z);
  ball.from_world.row(0) = place.Direction(1, 0, 0).transpose() / radii.x();
  ball.from_world.row(1) = place.Direction(0, 1, 0).transpose() / radii.y();
  ball.from_world.row(2) = Vector3d(0, 0, 1 / radii.z()).transpose();
  ball.radius = radii.maxCoeff();
  ball.size = 2 * std::numbers::pi * ball.radius;
  ball.texture = texture;
  builder_.Add(ball);
}

void Furnisher::Hang(const Place& wall, double x, double z, double width, double height,
                     int texture, double thickness) {
  BoxFaces faces = BoxFaces::All(builder_.Tone(150));
  faces.front = texture;
  faces.back = -1;
  Box(wall, {x - width / 2, -thickness, z - height / 2}, {width, thickness, height}, faces);
}

void Furnisher::Poster(const Place& wall, double x, double z, double width, double height) {
  Hang(wall, x, z, width, height, Picture(PaintPoster, width, height), 0.006);
}

void Furnisher::Door(const Place& wall, double x, int number) {
  const cv::Size size = Texels(0.95, 2.08, density_);
  const int texture =
      builder_.Paint([=](Random& random) { return PaintDoor(random, size, number); });
  Hang(wall, x, 1.04, 0.95, 2.08, texture, 0.03);
}

void Furnisher::Window(const Place& wall, double x) {
  Hang(wall, x, 1.6, 1.5, 1.2, Picture(PaintWindow, 1.5, 1.2), 0.02);
  Hang(wall, x, 0.45, 1.2, 0.6, Picture(PaintRadiator, 1.2, 0.6), 0.09);
  Box(wall, {x - 0.8, -0.16, 0.94}, {1.6, 0.16, 0.03}, BoxFaces::All(builder_.Tone(205)));
}

namespace {

constexpr double kThickness = 0.07;  // meters: half of the thickness of a wall between two rooms
constexpr double kOpeningHeight = 2.1;

void AddPanel(Furnisher& furnish, const Place& wall, double from, double to, double low,
              double high, const WallFinish& finish) {
  if (to - from < 1e-6) return;
  const double w = to - from, h = high - low;
  Rect rect;
  rect.origin = wall.Point(from, 0, high);
  rect.right = wall.Direction(w, 0, 0);
  rect.down = Vector3d(0, 0, -h);
  rect.texture = furnish.Material(finish.paint, w, h, finish.tone, 0.6);
  furnish.builder().Add(std::move(rect));
  furnish.Shade(wall, {from, 0, low}, {w, kThickness, h});
  if (low > 0) return;
  // Skirting board.
  const int tone = furnish.builder().Tone(95);
  furnish.Box(wall, {from, -0.012, 0}, {w, 0.012, 0.07}, {tone, -1, tone, tone, tone, -1});
}

}  // namespace

Place AtWall(const Vector2d& a, const Vector2d& b, double along, double off) {
  // As seen from the room: a is on the right, because the room is to the left of a → b.
  const Vector2d direction = (b - a).normalized();
  const double yaw = std::atan2(-direction.y(), -direction.x());
  const Vector2d inward(-direction.y(), direction.x());
  const Vector2d p = a + along * direction + off * inward;
  return {{p.x(), p.y(), 0}, yaw};
}

void AddWall(Furnisher& furnish, const Vector2d& a, const Vector2d& b, double height,
             const WallFinish& finish, const std::vector<Opening>& openings) {
  const double length = (b - a).norm();
  const Place wall = AtWall(a, b, length);  // x runs from b to a
  double done = 0;
  const int jamb = furnish.builder().Tone(150);
  for (auto opening = openings.rbegin(); opening != openings.rend(); ++opening) {
    const double from = length - opening->to, to = length - opening->from;
    AddPanel(furnish, wall, done, from, 0, height, finish);
    AddPanel(furnish, wall, from, to, kOpeningHeight, height, finish);
    // Jambs and lintel cover this room's half of the wall's thickness.
    const double w = to - from;
    furnish.Box(wall, {from - 0.01, 0, 0}, {0.01, kThickness, kOpeningHeight},
                {-1, -1, -1, jamb, -1, -1});
    furnish.Box(wall, {to, 0, 0}, {0.01, kThickness, kOpeningHeight}, {-1, -1, jamb, -1, -1, -1});
    furnish.Box(wall, {from, 0, kOpeningHeight}, {w, kThickness, 0.01}, {-1, -1, -1, -1, -1, jamb});
    const int frame = furnish.builder().Tone(215);
    furnish.Box(wall, {from - 0.06, -0.015, 0}, {0.06, 0.015, kOpeningHeight + 0.06},
                {frame, -1, frame, frame, -1, -1});
    furnish.Box(wall, {to, -0.015, 0}, {0.06, 0.015, kOpeningHeight + 0.06},
                {frame, -1, frame, frame, -1, -1});
    furnish.Box(wall, {from, -0.015, kOpeningHeight}, {w, 0.015, 0.06},
                {frame, -1, -1, -1, -1, frame});
    // Threshold.
    furnish.Box(wall, {from, 0, -0.01}, {w, kThickness, 0.01}, {-1, -1, -1, -1, jamb, -1});
    done = to;
  }
  AddPanel(furnish, wall, done, length, 0, height, finish);
}

void AddFloor(Furnisher& furnish, const Vector2d& low, const Vector2d& high,
              Furnisher::ToneFn paint, double tone) {
  const Vector2d size = high - low;
  Rect rect;
  rect.origin = {low.x(), high.y(), 0};
  rect.right = {size.x(), 0, 0};
  rect.down = {0, -size.y(), 0};
  rect.texture = furnish.Material(paint, size.x(), size.y(), tone, 0.7);
  furnish.builder().Add(std::move(rect));
  furnish.Shade({}, {low.x(), low.y(), -0.1}, {size.x(), size.y(), 0.1});
}

void AddCeiling(Furnisher& furnish, const Vector2d& low, const Vector2d& high, double height) {
  const Vector2d size = high - low;
  Rect rect;
  rect.origin = {low.x(), low.y(), height};
  rect.right = {size.x(), 0, 0};
  rect.down = {0, size.y(), 0};
  rect.texture = furnish.Material(PaintPlaster, size.x(), size.y(), 205, 0.3);
  furnish.builder().Add(std::move(rect));
  furnish.Shade({}, {low.x(), low.y(), height}, {size.x(), size.y(), 0.1});
}

}  // namespace alidade
