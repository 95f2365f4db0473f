#include "alidade/geometry/eigen_transforms.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/expect_error.h"

namespace alidade::eigen_transforms_test {
namespace {

using testing::HasSubstr;

const Se3 kPose = Se3::Exp((Vector6d() << 1, -2, 3, 0.4, -0.5, 0.6).finished());

TEST(EigenTransforms, MovePointsAlike) {
  const Eigen::Vector3d p(0.3, 0.7, -1.1);
  EXPECT_LT((ToIsometry(kPose) * p - kPose * p).norm(), 1e-12);
  EXPECT_LT(((ToMatrix(kPose) * p.homogeneous()).head<3>() - kPose * p).norm(), 1e-12);
  const Sim3 similar{2.5, kPose.R, kPose.t};
  EXPECT_LT(((ToMatrix(similar) * p.homogeneous()).head<3>() - similar * p).norm(), 1e-12);
}

TEST(EigenTransforms, ReturnTheSamePose) {
  const Se3 isometry = FromIsometry(ToIsometry(kPose));
  EXPECT_EQ(isometry.R, kPose.R);
  EXPECT_EQ(isometry.t, kPose.t);
  const Se3 matrix = FromMatrix(ToMatrix(kPose));
  EXPECT_LT((matrix.R - kPose.R).norm(), 1e-12);
  EXPECT_EQ(matrix.t, kPose.t);
}

TEST(EigenTransforms, WhatIsNoPoseIsAnError) {
  const auto complaint = [](const Eigen::Matrix4d& matrix) {
    return MessageOf(ErrorKind::kInput, [&] { FromMatrix(matrix); });
  };
  const Eigen::Matrix4d good = ToMatrix(kPose);
  EXPECT_THAT(complaint(good.transpose()), HasSubstr("transposed"));
  Eigen::Matrix4d bad = good;
  bad.topLeftCorner<3, 3>() *= 2;
  EXPECT_THAT(complaint(bad), HasSubstr("rotation"));
  bad = good;
  bad.col(0) *= -1;  // a mirror
  EXPECT_THAT(complaint(bad), HasSubstr("rotation"));
  bad = good;
  bad(0, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(complaint(bad), HasSubstr("not finite"));
}

}  // namespace
}  // namespace alidade::eigen_transforms_test
