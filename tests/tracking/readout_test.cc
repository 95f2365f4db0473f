// Estimating the rolling-shutter readout time from tracked frames.
#include "alidade/tracking/readout.h"

#include <gtest/gtest.h>

#include <cmath>

#include "alidade/base/random.h"

namespace alidade::readout_test {
namespace {

// Exact landmarks, observed with a readout time that is longer by `longer` than assumed, and with a
// pose error.
std::vector<ReadoutMatch> Frame(const Camera& camera, const Vector6d& motion,
                                const Eigen::Vector2d& longer, double noise, Random& random) {
  std::vector<ReadoutMatch> matches;
  const Vector6d off = (Vector6d() << 0.01, -0.02, 0.01, 0.002, 0.003, -0.002).finished();
  for (int i = 0; i < 200; ++i) {
    const double z = random.Uniform(2, 5);
    const Eigen::Vector2d raw(random.Uniform(0, camera.width - 1),
                              random.Uniform(0, camera.height - 1));
    const Eigen::Vector3d p = camera.Unproject(raw, z);
    const double seconds = longer.x() * ((raw.x() + 0.5) / camera.width - 0.5) +
                           longer.y() * ((raw.y() + 0.5) / camera.height - 0.5);
    const Eigen::Vector2d seen = camera.Project(Se3::Exp(seconds * motion) * (Se3::Exp(off) * p));
    matches.push_back({p,
                       seen - camera.Project(p) +
                           noise * Eigen::Vector2d(random.Uniform(-1, 1), random.Uniform(-1, 1)),
                       raw, 1});
  }
  return matches;
}

TEST(ReadoutSum, TellsHowMuchLongerTheShutterTakes) {
  for (const Eigen::Vector2d& longer : {Eigen::Vector2d(0, 0.008), Eigen::Vector2d(-0.005, 0)}) {
    const bool upright = longer.x() != 0;  // sensor rows are image columns
    const Camera camera = Camera::FromFieldOfView(640, upright ? 720 : 480, 66);
    ReadoutSum sum(camera);
    Random random(3);
    for (int i = 0; i < 20; ++i) {
      const Vector6d motion = (Vector6d() << random.Uniform(-0.3, 0.3), 0.1, 0,
                               random.Uniform(-1, 1), random.Uniform(-1, 1), 0.2)
                                  .finished();
      sum.Add(motion, Frame(camera, motion, longer, 0.5, random));
    }
    const ReadoutSum::Told told = sum.told();
    EXPECT_EQ(told.frames, 20);
    EXPECT_NEAR(told.change, longer.sum(), 3e-4);
    EXPECT_LT(told.sigma, 1e-3);
  }
}

TEST(ReadoutSum, ACameraThatStandsTellsNothing) {
  const Camera camera = Camera::FromFieldOfView(640, 480, 66);
  ReadoutSum sum(camera);
  Random random(3);
  sum.Add(Vector6d::Zero(), Frame(camera, Vector6d::Zero(), {0, 0.02}, 0.5, random));
  EXPECT_EQ(sum.told().frames, 0);
  EXPECT_TRUE(std::isinf(sum.told().sigma));
}

}  // namespace
}  // namespace alidade::readout_test
