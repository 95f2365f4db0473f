#include "alidade/synth/actor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "alidade/synth/paint/paint.h"

namespace alidade {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double kPi = std::numbers::pi;

// Frame with x ahead, y to the left, z up.
struct Stance {
  Vector3d foot;
  double c, s;
  Vector3d At(double ahead, double left, double up) const {
    return foot + Vector3d(c * ahead - s * left, s * ahead + c * left, up);
  }
};

// Ellipsoid with radii along the axes of the stance.
Quadric Blob(const Stance& stance, const Vector3d& centre, const Vector3d& radii, int texture) {
  Quadric ball;
  ball.origin = ball.centre = centre;
  ball.from_world.row(0) = Vector3d(stance.c, stance.s, 0).transpose() / radii.x();
  ball.from_world.row(1) = Vector3d(-stance.s, stance.c, 0).transpose() / radii.y();
  ball.from_world.row(2) = Vector3d(0, 0, 1).transpose() / radii.z();
  ball.radius = radii.maxCoeff();
  ball.size = 2 * kPi * std::max(radii.x(), radii.y());
  ball.texture = texture;
  ball.actor = true;
  return ball;
}

// Limb or trunk from `low` to `high`. Elliptic cross section with half-axes `deep` (ahead) and
// `wide` at `low`, scaled by `top` at `high`.
Quadric Limb(const Stance& stance, const Vector3d& low, const Vector3d& high, double deep,
             double wide, double top, int texture) {
  Quadric limb;
  limb.kind = Quadric::Kind::kFrustum;
  limb.origin = low;
  const Vector3d axis = high - low;
  const Vector3d left(-stance.s, stance.c, 0);
  // Columns span the limb: ahead, left, axis. Slightly non-orthogonal when it swings sideways,
  // which is harmless.
  Eigen::Matrix3d to_world;
  to_world.col(0) = left.cross(axis).normalized() * deep;
  to_world.col(1) = left * wide;
  to_world.col(2) = axis;
  limb.from_world = to_world.inverse();
  limb.top = top;
  limb.centre = (low + high) / 2;
  limb.radius = std::hypot(axis.norm() / 2, std::max(deep, wide) * std::max(1.0, top));
  limb.size = 2 * kPi * std::max(deep, wide);
  limb.texture = texture;
  limb.actor = true;
  return limb;
}

}  // namespace

Actor::Actor(ActorLooks looks, Walk walk, double start, double speed, double wander_phase)
    : looks_(looks),
      walk_(std::move(walk)),
      until_{0},
      start_(start),
      speed_(speed),
      wander_phase_(wander_phase) {
  for (size_t i = 0; i < walk_.size(); ++i)
    until_.push_back(until_.back() + (walk_[(i + 1) % walk_.size()] - walk_[i]).norm());
}

double Actor::Along(double time) const {
  // Varies the speed with a period of 11 s, almost stopping once per period.
  const double rhythm = 2 * kPi / 11;
  return start_ + speed_ * (time + 0.9 / rhythm * std::sin(rhythm * time + wander_phase_));
}

Vector2d Actor::At(double along) const {
  along -= std::floor(along / until_.back()) * until_.back();
  size_t i = 0;
  while (i + 2 < until_.size() && until_[i + 1] < along) ++i;
  return walk_[i] + (along - until_[i]) / (until_[i + 1] - until_[i]) *
                        (walk_[(i + 1) % walk_.size()] - walk_[i]);
}

Vector2d Actor::Position(double time) const {
  // Rounds the corners: mean over the path from 0.35 m behind to 0.35 m ahead.
  const double along = Along(time);
  Vector2d sum = Vector2d::Zero();
  for (int i = -3; i <= 3; ++i) sum += At(along + 0.35 * i / 3);
  return sum / 7;
}

std::vector<Quadric> Actor::Body(double time) const {
  const double along = Along(time), direction = speed_ < 0 ? -1 : 1;
  const Vector2d p = Position(time),
                 ahead = direction * (At(along + direction * 0.4) - At(along - direction * 0.4)) *
                         direction;
  const double heading = std::atan2(ahead.y(), ahead.x());
  const double h = looks_.height, g = looks_.girth;
  const Stance stance = {Vector3d(p.x(), p.y(), 0), std::cos(heading), std::sin(heading)};
  const double step = 2 * kPi * along * direction / (0.78 * h);  // a full cycle is two steps
  const double bob = 0.012 * h * std::cos(2 * step);

  std::vector<Quadric> body;
  const double hip = 0.5 * h + bob, shoulder = 0.815 * h + bob;
  for (const int side : {-1, 1}) {
    const double swing = 0.42 * std::sin(step + (side > 0 ? kPi : 0));
    const double bend =
        // Bend of the knee while the leg swings ahead.
        0.25 + 0.35 * std::max(0.0, std::cos(step + (side > 0 ? kPi : 0)));
    const double thigh = 0.245 * h, shin = 0.235 * h;
    const Vector3d joint = stance.At(0, side * 0.052 * h, hip);
    const Vector3d knee =
        joint +
        stance.At(thigh * std::sin(swing + 0.3 * bend), 0, -thigh * std::cos(swing + 0.3 * bend)) -
        stance.foot;
    const double lower = swing - 0.7 * bend;
    const Vector3d ankle =
        knee + stance.At(shin * std::sin(lower), 0, -shin * std::cos(lower)) - stance.foot;
    body.push_back(Limb(stance, knee, joint, 0.036 * h * g, 0.036 * h * g, 1.5, looks_.trousers));
    body.push_back(Blob(stance, knee, Vector3d::Constant(0.037 * h * g), looks_.trousers));
    body.push_back(Limb(stance, ankle, knee, 0.026 * h * g, 0.026 * h * g, 1.4, looks_.trousers));
    body.push_back(Blob(stance, ankle + stance.At(0.035 * h, 0, -0.012 * h) - stance.foot,
                        {0.075 * h, 0.028 * h, 0.026 * h}, looks_.shoes));

    const double arm = -0.5 * std::sin(step + (side > 0 ? kPi : 0)), out = 0.06 * side;
    const Vector3d top = stance.At(0, side * 0.118 * h * g, shoulder - 0.02 * h);
    const Vector3d elbow =
        top + stance.At(0.17 * h * std::sin(arm), 0.17 * h * out, -0.17 * h * std::cos(arm)) -
        stance.foot;
    const double fore = arm + 0.35;
    const Vector3d wrist =
        elbow + stance.At(0.15 * h * std::sin(fore), 0, -0.15 * h * std::cos(fore)) - stance.foot;
    body.push_back(Blob(stance, top, Vector3d::Constant(0.037 * h * g), looks_.sleeves));
    body.push_back(Limb(stance, elbow, top, 0.025 * h * g, 0.025 * h * g, 1.35, looks_.sleeves));
    body.push_back(Blob(stance, elbow, Vector3d::Constant(0.026 * h * g), looks_.sleeves));
    body.push_back(Limb(stance, wrist, elbow, 0.018 * h, 0.018 * h, 1.4, looks_.sleeves));
    body.push_back(Blob(stance, wrist + stance.At(0.01 * h, 0, -0.03 * h) - stance.foot,
                        {0.022 * h, 0.018 * h, 0.045 * h}, looks_.skin));
  }
  body.push_back(Blob(stance, stance.At(0, 0, hip + 0.005 * h),
                      {0.062 * h * g, 0.092 * h * g, 0.075 * h}, looks_.trousers));
  body.push_back(Limb(stance, stance.At(0, 0, hip), stance.At(0.01 * h, 0, shoulder), 0.062 * h * g,
                      0.088 * h * g, 1.22, looks_.shirt));
  body.push_back(Blob(stance, stance.At(0.01 * h, 0, shoulder - 0.005 * h),
                      {0.07 * h * g, 0.108 * h * g, 0.042 * h}, looks_.shirt));
  body.push_back(Limb(stance, stance.At(0.01 * h, 0, shoulder),
                      stance.At(0.015 * h, 0, shoulder + 0.07 * h), 0.032 * h, 0.032 * h, 0.95,
                      looks_.skin));
  body.push_back(Blob(stance, stance.At(0.02 * h, 0, 0.93 * h + bob),
                      {0.054 * h, 0.045 * h, 0.068 * h}, looks_.head));
  return body;
}

ActorLooks DressActor(SceneBuilder& builder, Random& random) {
  ActorLooks looks;
  looks.height = random.Uniform(1.62, 1.88);
  looks.girth = random.Uniform(0.9, 1.2);
  looks.head = builder.Paint([](Random& r) { return PaintHead(r, {420, 230}); });
  const ShirtStyle shirt = PickShirt(random);
  looks.shirt = builder.Paint([shirt](Random& r) {
    return PaintShirt(r, {640, 340}, shirt, false);
  });
  looks.sleeves = builder.Paint([shirt](Random& r) {
    return PaintShirt(r, {240, 240}, shirt, true);
  });
  looks.trousers = builder.Paint([](Random& r) { return PaintTrousers(r, {320, 260}); });
  looks.shoes = builder.Tone(40);
  looks.skin = builder.Tone(150);
  return looks;
}

std::vector<Actor> CastActors(const std::vector<ActorLooks>& looks, const std::vector<Walk>& walks,
                              const CameraPath& path, double seconds, uint64_t seed) {
  Random random(seed, 31);
  std::vector<Actor> cast;
  for (size_t i = 0; i < looks.size(); ++i) {
    // Best of 30 random walks: the one that keeps the largest distance to the camera and the other
    // actors.
    std::vector<Actor> best;
    double most_room = -1;
    for (int attempt = 0; attempt < 30; ++attempt) {
      const Walk& walk = walks[i % walks.size()];
      const double pace = random.Uniform(0.45, 0.9);
      const double speed = random.Uniform() < 0.5 ? -pace : pace;
      const double phase = random.Uniform(0, 2 * kPi), start = random.Uniform(0, 30);
      const Actor actor(looks[i], walk, start, speed, phase);
      double room = 10;
      for (double time = 0; time < seconds; time += 0.25) {
        const Vector2d p = actor.Position(time);
        room = std::min(room, (p - path.UnshakenPosition(time).head<2>()).norm());
        for (const Actor& other : cast)
          room = std::min(room, 1.5 * (p - other.Position(time)).norm());
      }
      room = std::min(room, 1.2);  // a larger distance is not better
      if (room > most_room) {
        most_room = room;
        best = {actor};
      }
    }
    cast.push_back(best.front());
  }
  return cast;
}

}  // namespace alidade
