// The orbit camera and its gestures.
#include "alidade/gles/orbit.h"

#include <gtest/gtest.h>

#include "alidade/base/random.h"
#include "gles/expected.h"
#include "gles/told_scene.h"

namespace alidade::gles_test::orbit_test {
namespace {

using gles::Orbit;
using gles::ViewSettings;

constexpr int kWidth = 400, kHeight = 300;

Eigen::Vector2d See(const Orbit& orbit, const Eigen::Vector3d& p) {
  ViewSettings view;
  orbit.Apply(view);
  return Lens(view, kWidth, kHeight).See(p).value_or(Eigen::Vector2d(-1, -1));
}

TEST(Orbit, LooksAtItsCentreWithUpUp) {
  Orbit orbit;
  orbit.centre = {1, 2, 3};
  for (double yaw : {0.0, 1.0, -2.5}) {
    for (double pitch : {0.0, 0.7, -0.4}) {
      orbit.yaw = yaw;
      orbit.pitch = pitch;
      EXPECT_LT((See(orbit, orbit.centre) - Eigen::Vector2d(200, 150)).norm(), 1e-9);
      const Eigen::Vector2d above = See(orbit, orbit.centre + Eigen::Vector3d(0, -0.5, 0));
      EXPECT_NEAR(above.x(), 200, 1e-6);
      EXPECT_LT(above.y(), 150);
      const Se3 eye = orbit.T_world_eye();
      EXPECT_NEAR(eye.R.determinant(), 1, 1e-12);
      EXPECT_NEAR((eye.t - orbit.centre).norm(), orbit.distance, 1e-9);
      EXPECT_NEAR(-(eye.t - orbit.centre).y(), orbit.distance * std::sin(pitch), 1e-9);
    }
  }
}

TEST(Orbit, FollowsTheFinger) {
  Orbit orbit;
  orbit.yaw = orbit.pitch = 0.2;
  ViewSettings view;
  // Points in front of the center follow the finger.
  const Eigen::Vector3d front = orbit.T_world_eye() * Eigen::Vector3d(0, 0, orbit.distance - 0.5);
  Orbit turned = orbit;
  turned.Turn(10, 0, kHeight);
  EXPECT_GT(See(turned, front).x(), See(orbit, front).x() + 0.1);
  turned = orbit;
  turned.Turn(0, 10, kHeight);
  EXPECT_GT(See(turned, front).y(), See(orbit, front).y() + 0.1);
  turned.Turn(0, 1e6, kHeight);
  EXPECT_LT(turned.pitch, 1.571);

  Orbit panned = orbit;
  panned.Pan(30, -20, kHeight, view.fov);
  const Eigen::Vector2d moved = See(panned, orbit.centre) - See(orbit, orbit.centre);
  EXPECT_LT((moved - Eigen::Vector2d(30, -20)).norm(), 1e-6);

  Orbit nearer = orbit;
  nearer.Zoom(2);
  EXPECT_DOUBLE_EQ(nearer.distance, orbit.distance / 2);
  nearer.Zoom(0);
  nearer.Zoom(-1);
  EXPECT_DOUBLE_EQ(nearer.distance, orbit.distance / 2);
}

// A room mapped by a camera held upright or rotated as phones are: up remains up, and the room is
// in view.
TEST(Orbit, FitsTheMapAndStandsUpright) {
  Random random(9);
  for (int rotation : {0, 90, 180, 270}) {
    const Eigen::Vector3d up = Eigen::Vector3d(0.3, -1, 0.2).normalized();  // in the world
    const Eigen::Vector3d ahead = up.cross(Eigen::Vector3d(1, 0, 0)).normalized();
    Se3 upright;  // a camera that looks forward with an upright image
    upright.R.col(1) = -up;
    upright.R.col(2) = ahead;
    upright.R.col(0) = upright.R.col(1).cross(ahead);
    // A clockwise rotation of the camera rotates its image counterclockwise.
    const double angle = rotation * 3.14159265358979 / 180;
    const Se3 held{upright.R * ExpSo3({0, 0, angle}), {}};
    Teller teller(Camera::FromFieldOfView(640, 480, 60));
    Change change;
    for (uint32_t k = 0; k < 10; ++k) {
      const double x = 0.1 * k;
      const Eigen::Vector3d shake(random.Uniform(-0.1, 0.1), 0, 0);
      change.keyframes.push_back({k, 0, {held.R * ExpSo3(shake), {x, 0, 0}}, 1});
      for (uint32_t i = 0; i < 20; ++i) {
        const double u = random.Uniform(-1, 1);
        const double v = random.Uniform(-1, 1);
        change.landmarks.push_back(
            {20 * k + i, k, Eigen::Vector3f(static_cast<float>(u), static_cast<float>(v), 3)});
      }
    }
    teller.Tell(change);
    Orbit orbit;
    orbit.Fit(teller.scene, rotation);
    EXPECT_GT(orbit.axes.row(2).dot(up), 0.99) << rotation;
    EXPECT_NEAR((orbit.axes * orbit.axes.transpose() - Eigen::Matrix3d::Identity()).norm(), 0,
                1e-9);
    EXPECT_NEAR(orbit.axes.determinant(), 1, 1e-9);
    teller.scene.worlds = {{MapId{0}, true, 0.01, Eigen::Vector3d(0.6, 0.8, 0), 0.01}};
    Orbit by_gravity;
    by_gravity.Fit(teller.scene, rotation);
    EXPECT_NEAR(by_gravity.axes.row(2).dot(Eigen::Vector3d(-0.6, -0.8, 0)), 1, 1e-9);
    int seen = 0;
    for (const auto& [id, landmark] : teller.scene.landmarks)
      seen += See(orbit, teller.scene.PointOf(landmark)).x() >= 0;
    EXPECT_GE(seen, 180);
    for (const auto& [id, keyframe] : teller.scene.keyframes)
      EXPECT_GE(See(orbit, keyframe.T_world_camera.t).x(), 0);
  }
  Orbit orbit;
  EXPECT_NO_THROW(orbit.Fit(StreamScene(), 90));  // no map yet
  EXPECT_TRUE(orbit.T_world_eye().R.allFinite());
}

}  // namespace
}  // namespace alidade::gles_test::orbit_test
