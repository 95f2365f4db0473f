#include "alidade/geometry/alignment.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/random.h"

namespace alidade::alignment_test {
namespace {

using Points = std::vector<Eigen::Vector3d>;

Eigen::Vector3d RandomPoint(Random& random, double size) {
  const double x = random.Uniform(-size, size), y = random.Uniform(-size, size);
  return {x, y, random.Uniform(-size, size)};
}

Points RandomPoints(Random& random, int count, double size = 5) {
  Points points;
  for (int i = 0; i < count; ++i) points.push_back(RandomPoint(random, size));
  return points;
}

Eigen::Matrix3d RandomRotation(Random& random) {
  Eigen::Quaterniond q(random.Gaussian(), random.Gaussian(), random.Gaussian(), random.Gaussian());
  return q.normalized().toRotationMatrix();
}

Points Moved(const Sim3& T, const Points& points) {
  Points moved;
  for (const Eigen::Vector3d& p : points) moved.push_back(T * p);
  return moved;
}

double SquaredError(const Sim3& T, const Points& target, const Points& source) {
  double sum = 0;
  for (size_t i = 0; i < target.size(); ++i) sum += (target[i] - T * source[i]).squaredNorm();
  return sum;
}

std::string MessageOf(const Points& target, const Points& source, bool with_scale) {
  try {
    AlignPoints(target, source, with_scale);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInput);
    return error.what();
  }
  return "";
}

TEST(AlignPoints, FindsAnExactSimilarity) {
  Random random(3);
  for (int trial = 0; trial < 50; ++trial) {
    const Sim3 truth{random.Uniform(0.1, 10), RandomRotation(random), RandomPoint(random, 20)};
    const Points source = RandomPoints(random, 3 + trial);
    const Sim3 found = AlignPoints(Moved(truth, source), source, true);
    EXPECT_NEAR(found.s, truth.s, 1e-9);
    EXPECT_LT((found.R - truth.R).norm(), 1e-9);
    EXPECT_LT((found.t - truth.t).norm(), 1e-8);
  }
}

TEST(AlignPoints, AgreesWithEigenOnNoisyPoints) {
  Random random(4);
  for (int trial = 0; trial < 50; ++trial) {
    const Points source = RandomPoints(random, 20);
    const Sim3 truth{trial % 2 ? 2.5 : 1.0, RandomRotation(random), RandomPoint(random, 20)};
    Points target = Moved(truth, source);
    for (Eigen::Vector3d& p : target) p += RandomPoint(random, 1.0);
    Eigen::Matrix3Xd a(3, 20), b(3, 20);
    for (int i = 0; i < 20; ++i) {
      a.col(i) = source[i];
      b.col(i) = target[i];
    }
    for (const bool with_scale : {false, true}) {
      const Eigen::Matrix4d oracle = Eigen::umeyama(a, b, with_scale);
      const Sim3 found = AlignPoints(target, source, with_scale);
      EXPECT_LT((found.s * found.R - oracle.topLeftCorner<3, 3>()).norm(), 1e-9);
      EXPECT_LT((found.t - oracle.topRightCorner<3, 1>()).norm(), 1e-9);
      if (!with_scale) {
        EXPECT_EQ(found.s, 1.0);
      }
    }
  }
}

TEST(AlignPoints, NeverReturnsAReflection) {
  Random random(5);
  const Points source = RandomPoints(random, 10);
  Points mirrored = source;
  for (Eigen::Vector3d& p : mirrored) p.x() = -p.x();
  EXPECT_NEAR(AlignPoints(mirrored, source, true).R.determinant(), 1, 1e-9);
}

TEST(AlignPoints, HandlesPlanesAndLines) {
  Random random(6);
  for (int trial = 0; trial < 50; ++trial) {
    const Sim3 truth{random.Uniform(0.5, 2), RandomRotation(random), RandomPoint(random, 20)};
    Points plane = RandomPoints(random, 10), line = plane;
    for (Eigen::Vector3d& p : plane) p.z() = 0;
    for (Eigen::Vector3d& p : line) p.y() = p.z() = 0;
    for (const Points& source : {plane, line}) {
      const Points target = Moved(truth, source);
      const Sim3 found = AlignPoints(target, source, true);
      EXPECT_LT(SquaredError(found, target, source), 1e-16);
      EXPECT_NEAR(found.R.determinant(), 1, 1e-9);
    }
  }
}

TEST(AlignPoints, KeepsItsAccuracyFarFromTheOrigin) {
  Random random(7);
  const Points source = RandomPoints(random, 30);
  // Large offsets, as in map coordinates.
  const Sim3 far{1, RandomRotation(random), {6e5, -5e6, 100}};
  const Points target = Moved(far, source);
  EXPECT_LT(std::sqrt(SquaredError(AlignPoints(target, source, false), target, source) / 30), 1e-7);
}

TEST(AlignPoints, SaysWhatIsWrongWithPointsThatCannotBeAligned) {
  Random random(8);
  const Points good = RandomPoints(random, 5);
  const Points same(5, Eigen::Vector3d(0.1, 0.2, 0.3));
  Points broken = good;
  broken[3].y() = std::numeric_limits<double>::quiet_NaN();
  Points endless = good;
  endless[1].x() = std::numeric_limits<double>::infinity();
  for (const bool with_scale : {false, true}) {
    EXPECT_NE(MessageOf({}, {}, with_scale).find("at least 3"), std::string::npos);
    EXPECT_NE(MessageOf({good[0], good[1]}, {good[0], good[1]}, with_scale).find("at least 3"),
              std::string::npos);
    EXPECT_NE(MessageOf(same, good, with_scale).find("same point"), std::string::npos);
    EXPECT_NE(MessageOf(good, same, with_scale).find("same point"), std::string::npos);
    EXPECT_NE(MessageOf(broken, good, with_scale).find("point 3 of the target"), std::string::npos);
    EXPECT_NE(MessageOf(good, endless, with_scale).find("point 1 of the source"),
              std::string::npos);
    EXPECT_NE(MessageOf(good, {good[0], good[1], good[2]}, with_scale).find("5 target points"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace alidade::alignment_test
