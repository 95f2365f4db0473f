#include "alidade/synth/thing.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "alidade/base/random.h"
#include "alidade/synth/paint/paint.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;

// Cone frustum from `low` to `high` with two radii, meters.
Quadric Round(const Vector3d& low, const Vector3d& high, const Vector3d& sideways, double foot,
              double rim, int texture) {
  Quadric round;
  round.kind = Quadric::Kind::kFrustum;
  round.origin = low;
  const Vector3d axis = high - low;
  const Vector3d side = (sideways - axis * (sideways.dot(axis) / axis.squaredNorm())).normalized();
  Matrix3d to_world;
  to_world << side * foot, axis.normalized().cross(side) * foot, axis;
  round.from_world = to_world.inverse();
  round.top = rim / foot;
  round.centre = (low + high) / 2;
  round.radius = std::hypot(axis.norm() / 2, std::max(foot, rim));
  round.size = 2 * kPi * std::max(foot, rim);
  round.texture = texture;
  round.actor = true;
  return round;
}

Quadric Ball(const Vector3d& centre, const Matrix3d& axes, const Vector3d& radii, int texture) {
  Quadric ball;
  ball.origin = ball.centre = centre;
  ball.from_world = radii.cwiseInverse().asDiagonal() * axes.transpose();
  ball.radius = radii.maxCoeff();
  ball.size = 2 * kPi * ball.radius;
  ball.texture = texture;
  ball.actor = true;
  return ball;
}

}  // namespace

Thing::Thing(const ThingLooks& looks, const TableTop& table, double phase)
    : looks_(looks), table_(table), phase_(phase) {}

double Thing::Done(double time) const {
  const double rhythm = 2 * kPi / 5;  // it pauses briefly every five seconds
  return time + 0.95 / rhythm * std::sin(rhythm * time + phase_);
}

Vector3d Thing::Foot(double time) const {
  const double s = Done(time);
  const double lift = 0.02 * (1 - std::cos(1.7 * s + phase_));
  return table_.middle + Vector3d(table_.half_x * std::sin(0.9 * s + phase_),
                                  table_.half_y * std::sin(0.7 * s + 2 * phase_), lift);
}

std::vector<Quadric> Thing::Parts(double time) const {
  const double s = Done(time);
  const Vector3d foot = Foot(time);
  const Matrix3d R = ExpSo3({0.15 * std::sin(1.3 * s + phase_), 0.12 * std::sin(s), 0}) *
                     ExpSo3({0, 0, 0.9 * std::sin(0.6 * s + phase_)});
  const Vector3d up = R.col(2) * looks_.height;
  std::vector<Quadric> parts;
  parts.push_back(
      Round(foot, foot + up, R.col(0), looks_.radius, 1.1 * looks_.radius, looks_.body));
  parts.push_back(
      Ball(foot + 0.98 * up, R, {1.08 * looks_.radius, 1.08 * looks_.radius, 0.012}, looks_.lid));
  const Vector3d along = table_.arm.normalized();
  const Vector3d outwards = Vector3d(along.x(), along.y(), 0).normalized();
  const Vector3d hand = foot + 0.45 * up + (looks_.radius + 0.02) * outwards;
  const Matrix3d level = Matrix3d::Identity();
  parts.push_back(Ball(hand, level, {0.03, 0.045, 0.05}, looks_.skin));
  parts.push_back(Round(hand, hand + 0.12 * along, {0, 0, 1}, 0.026, 0.03, looks_.skin));
  parts.push_back(
      Round(hand + 0.1 * along, hand + 0.6 * along, {0, 0, 1}, 0.042, 0.055, looks_.sleeve));
  if (looks_.shirt >= 0) {  // a person sitting there, swaying
    const double lean = 0.05 * std::sin(0.8 * s);
    const Vector3d seat(0.02 * lean, table_.sitter, 0.35), neck(lean, table_.sitter - 0.05, 1.27);
    parts.push_back(Round(seat, neck, {1, 0, 0}, 0.19, 0.22, looks_.shirt));
    parts.push_back(Ball(neck, level, {0.27, 0.16, 0.09}, looks_.shirt));
    parts.push_back(Ball(neck + Vector3d(0, -0.02, 0.2), level, {0.08, 0.1, 0.13}, looks_.head));
  }
  return parts;
}

std::vector<Thing> PutThings(SceneBuilder& builder, const TableTop& table, int count,
                             uint64_t seed) {
  Random random(seed, 61);  // separate stream: the scene is the same with and without objects
  std::vector<Thing> things;
  for (int i = 0; i < count; ++i) {
    ThingLooks looks;
    looks.radius = random.Uniform(0.055, 0.085);
    looks.height = random.Uniform(0.14, 0.22);
    const double around = 2 * kPi * looks.radius;
    const cv::Size size(cvRound(1500 * around), cvRound(1500 * looks.height));
    looks.body = builder.Paint([size](Random& r) { return PaintPoster(r, size); });
    const cv::Size lid(cvRound(1000 * around), cvRound(500 * around));
    looks.lid = builder.Paint([lid](Random& r) { return PaintCover(r, lid); });
    looks.skin = builder.Tone(150);
    const ShirtStyle shirt = PickShirt(random);
    looks.sleeve = builder.Paint([shirt](Random& r) {
      return PaintShirt(r, {300, 400}, shirt, true);
    });
    if (i == 0 && table.sitter != 0) {
      looks.shirt = builder.Paint([shirt](Random& r) {
        return PaintShirt(r, {640, 340}, shirt, false);
      });
      looks.head = builder.Paint([](Random& r) { return PaintHead(r, {420, 230}); });
    }
    TableTop part = table;
    part.half_x = table.half_x / count;
    part.middle.x() += table.half_x * ((2 * i + 1.0) / count - 1);
    things.emplace_back(looks, part, random.Uniform(0, 2 * kPi));
  }
  return things;
}

}  // namespace alidade
