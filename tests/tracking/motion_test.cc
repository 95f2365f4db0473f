#include "alidade/tracking/motion.h"

#include <gtest/gtest.h>

namespace alidade::motion_test {
namespace {

Se3 Turning() {  // along an arc
  return Se3::Exp((Vector6d() << 0.02, 0.001, 0.03, 0.01, -0.03, 0.002).finished());
}

double Difference(const Se3& a, const Se3& b) { return (a * b.Inverse()).Log().norm(); }

TEST(Motion, GoesOnAsTheLastFrameDid) {
  Motion motion;
  EXPECT_LT(Difference(motion.After(1), {}), 1e-15);
  motion.Add(Turning(), 0.033);
  EXPECT_EQ(motion.After(0.033).t, Turning().t);
}

TEST(Motion, IsTwiceAsFarWhenAFrameWasDropped) {
  Motion motion;
  motion.Add(Turning(), 0.033);
  EXPECT_LT(Difference(motion.After(0.066), Turning() * Turning()), 1e-12);
  EXPECT_LT(Difference(motion.After(0.132), Turning() * Turning() * Turning() * Turning()), 1e-12);
}

TEST(Motion, IsHalfAsFarWhenAFrameWasDroppedBefore) {
  Motion motion;
  motion.Add(Turning() * Turning(), 0.066);
  EXPECT_LT(Difference(motion.After(0.033), Turning()), 1e-12);
}

TEST(Motion, TakesUnsteadyStampsForASteadyCamera) {
  Motion motion;
  motion.Add(Turning(), 0.033);
  EXPECT_EQ(motion.After(0.04).t, Turning().t);
  EXPECT_EQ(motion.After(0.027).t, Turning().t);
}

TEST(Motion, IsNotDrawnOutForLongerThanSaid) {
  Motion motion({.max_extrapolation = 0.5});
  motion.Add(Turning(), 0.05);
  EXPECT_LT(Difference(motion.After(0.9), motion.After(0.5)), 1e-12);
  motion.Clear();
  motion.Add(Turning(), 2);  // a low frame rate
  EXPECT_LT(Difference(motion.After(2), Turning()), 1e-12);
  EXPECT_LT(Difference(motion.After(6), Turning()), 1e-12);
}

// Extrapolating the last step alone would multiply its error by ten.
TEST(Motion, DoesNotDrawOutTheNoiseOfOneShortStep) {
  Motion motion;
  Se3 last = Turning();
  for (int i = 0; i < 9; ++i) motion.Add(Turning(), 0.033);
  last.t.x() += 0.005;
  motion.Add(last, 0.033);
  Se3 ten;
  for (int i = 0; i < 10; ++i) ten = Turning() * ten;
  EXPECT_LT(Difference(motion.After(0.33), ten), 0.0055);
}

TEST(Motion, FollowsTheScaleOfTheMap) {
  Motion motion;
  motion.Add(Turning(), 0.033);
  motion.Add(Turning(), 0.033);
  const Se3 before = motion.After(0.066);
  motion.Scale(2);
  EXPECT_LT((motion.After(0.066).t - 2 * before.t).norm(), 1e-12);
  EXPECT_LT((motion.After(0.066).R - before.R).norm(), 1e-12);
}

}  // namespace
}  // namespace alidade::motion_test
