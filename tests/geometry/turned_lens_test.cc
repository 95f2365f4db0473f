#include "alidade/geometry/turned_lens.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>

#include "alidade/geometry/se3.h"

namespace alidade::turned_lens_test {
namespace {

constexpr double kFocal = 370;  // assumed focal length, pixels

// Matches of a camera that rotates by `degrees` with a focal length `g` times the assumed one, in
// images 480 pixels wide with 0.4 pixels of noise.
RayPairs Turned(double degrees, double g, std::mt19937& random) {
  std::uniform_real_distribution<double> across(-240, 240), down(-180, 180);
  std::normal_distribution<double> noise(0, 0.4);
  const Eigen::Matrix3d R =
      ExpSo3(Eigen::Vector3d(0.1, 1, 0.05).normalized() * degrees * std::numbers::pi / 180);
  RayPairs rays;
  rays.sigma = Eigen::Vector2d::Constant(0.5 / kFocal);
  while (rays.size() < 150) {
    const Eigen::Vector2d a(across(random), down(random));
    const Eigen::Vector3d p = R * (a / (g * kFocal)).homogeneous();
    if (p.z() < 0.1) continue;
    const Eigen::Vector2d b = g * kFocal * p.head<2>() / p.z();
    if (std::abs(b.x()) > 240 || std::abs(b.y()) > 180) continue;
    const auto pixel = [&](const Eigen::Vector2d& at) {
      const double u = noise(random), v = noise(random);
      return Eigen::Vector3d((at.x() + u) / kFocal, (at.y() + v) / kFocal, 1);
    };
    rays.a.push_back(pixel(a));
    rays.b.push_back(pixel(b));
  }
  return rays;
}

// For any starting point: a radial coefficient can compensate part of a wrong focal length.
TEST(TurnedLens, IsFoundWithLargeTurnsAndALensFarOff) {
  std::mt19937 random(3);
  for (const double g : {0.7, 0.8, 1.0, 1.2}) {
    for (const double degrees : {5.0, 15.0, 30.0, 45.0}) {
      for (int trial = 0; trial < 20; ++trial) {
        const RayPairs rays = Turned(degrees, g, random);
        // The rotation estimated together with a spurious translation if the lens is wrong.
        std::normal_distribution<double> off(0, 0.1);
        const Eigen::Vector3d wrong(off(random), off(random), off(random));
        const Eigen::Matrix3d R =
            ExpSo3(wrong) * ExpSo3(Eigen::Vector3d(0.1, 1, 0.05).normalized() * g * degrees *
                                   std::numbers::pi / 180);
        LensChange found;
        const std::vector<bool> turned = ExplainedByTurnedLens(R, rays, 0.6, &found);
        ASSERT_EQ(turned.size(), rays.size());
        EXPECT_GE(std::count(turned.begin(), turned.end(), true), 130)
            << g << " times, " << degrees << " degrees: " << found.g << ", " << found.k;
      }
    }
  }
}

}  // namespace
}  // namespace alidade::turned_lens_test
