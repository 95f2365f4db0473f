#include "alidade/geometry/rectify.h"

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "alidade/base/error.h"
#include "alidade/base/random.h"

namespace alidade::rectify_test {
namespace {

RawCamera EurocLeft() {
  return {Lens::kPinhole, 752,     480,     458.654,
          457.296,        367.215, 248.375, {-0.28340811, 0.07395907, 0.00019359, 1.76e-05, 0}};
}
RawCamera EurocRight() {
  return {Lens::kPinhole, 752,     480,     457.587,
          456.134,        379.999, 255.238, {-0.28368365, 0.07451284, -0.00010473, -3.6e-05, 0}};
}
// A slightly misaligned stereo pair: 2 degrees and 2 cm off the ideal.
Se3 CrookedPair() { return {ExpSo3({0.01, -0.03, 0.02}), {0.11, 0.005, -0.02}}; }

RawCamera Fisheye() {
  return {Lens::kFisheye, 512, 400, 190, 191, 254.9, 201.6, {0.0034, 0.0007, -0.002, 0.0002, 0}};
}

cv::Matx33d K(const RawCamera& c) { return {c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1}; }

// Raw position of pixel (u, v) of the rectified image according to the maps.
Eigen::Vector2d SourceOf(const RectifyMap& map, int u, int v) {
  const cv::Vec2s whole = map.coarse.at<cv::Vec2s>(v, u);
  const int fraction = map.fine.at<ushort>(v, u);  // 5 bits per axis
  return {whole[0] + (fraction & 31) / 32.0, whole[1] + (fraction >> 5) / 32.0};
}

TEST(RawCamera, ProjectsAsOpencvDoes) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d p(random.Uniform(-1, 1), random.Uniform(-0.7, 0.7),
                            random.Uniform(0.8, 3));
    const std::vector<cv::Point3d> points = {{p.x(), p.y(), p.z()}};
    const cv::Vec3d zero(0, 0, 0);
    std::vector<cv::Point2d> pixels;
    const RawCamera pinhole = EurocLeft(), fisheye = Fisheye();
    cv::projectPoints(points, zero, zero, K(pinhole), pinhole.distortion, pixels);
    EXPECT_LT((pinhole.Project(p) - Eigen::Vector2d(pixels[0].x, pixels[0].y)).norm(), 1e-9);
    const cv::Vec4d k(fisheye.distortion[0], fisheye.distortion[1], fisheye.distortion[2],
                      fisheye.distortion[3]);
    cv::fisheye::projectPoints(points, pixels, zero, zero, K(fisheye), k);
    EXPECT_LT((fisheye.Project(p) - Eigen::Vector2d(pixels[0].x, pixels[0].y)).norm(), 1e-9);
  }
}

TEST(RawCamera, DirectionUndoesProject) {
  Random random(2);
  for (const RawCamera& camera : {EurocLeft(), Fisheye()}) {
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector2d pixel(random.Uniform(0, camera.width - 1),
                                  random.Uniform(0, camera.height - 1));
      const Eigen::Vector3d direction = camera.Direction(pixel);
      EXPECT_NEAR(direction.norm(), 1, 1e-12);
      EXPECT_LT((camera.Project(direction) - pixel).norm(), 1e-6);
    }
  }
}

TEST(RectifyStereo, AgreesWithOpencvsMapsForTheSameRotations) {
  const Se3 T_left_right = CrookedPair();
  const RectifiedPair pair = RectifyStereo(EurocLeft(), EurocRight(), T_left_right);
  const Camera& c = pair.camera;
  const cv::Matx33d new_K(c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
  const Eigen::Matrix3d R_right_rectified = T_left_right.R.transpose() * pair.R_left_rectified;
  const auto check = [&](const RawCamera& raw, const Eigen::Matrix3d& R_raw_rectified,
                         const RectifyMap& map) {
    const Eigen::Matrix3d R = R_raw_rectified.transpose();
    const cv::Matx33d cv_R(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1),
                           R(2, 2));
    cv::Mat map_x, map_y;
    cv::initUndistortRectifyMap(K(raw), raw.distortion, cv_R, new_K, {752, 480}, CV_32FC1, map_x,
                                map_y);
    for (int v = 0; v < 480; v += 17) {
      for (int u = 0; u < 752; u += 19) {
        const Eigen::Vector2d expected(map_x.at<float>(v, u), map_y.at<float>(v, u));
        EXPECT_LT((SourceOf(map, u, v) - expected).cwiseAbs().maxCoeff(), 1.0 / 32)
            << u << " " << v;
      }
    }
  };
  check(EurocLeft(), pair.R_left_rectified, pair.left);
  check(EurocRight(), R_right_rectified, pair.right);
}

TEST(RectifyStereo, TurnsTheCamerasAsOpencvDoes) {
  const Se3 T_left_right = CrookedPair(), T_right_left = T_left_right.Inverse();
  const RectifiedPair pair = RectifyStereo(EurocLeft(), EurocRight(), T_left_right);
  cv::Matx33d R;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) R(r, c) = T_right_left.R(r, c);
  }
  const cv::Vec3d t(T_right_left.t.x(), T_right_left.t.y(), T_right_left.t.z());
  cv::Mat R1, R2, P1, P2, Q;
  cv::stereoRectify(K(EurocLeft()), EurocLeft().distortion, K(EurocRight()),
                    EurocRight().distortion, {752, 480}, R, t, R1, R2, P1, P2, Q,
                    cv::CALIB_ZERO_DISPARITY, 0);
  // Both align the rows with the baseline. About the baseline, OpenCV averages the rotations,
  // RectifyStereo() the viewing directions.
  Eigen::Matrix3d R_opencv;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) R_opencv(r, c) = R1.at<double>(c, r);
  }
  EXPECT_LT((R_opencv.col(0) - pair.R_left_rectified.col(0)).norm(), 1e-9);
  EXPECT_LT(RotationAngle({R_opencv, {}}, {pair.R_left_rectified, {}}),
            0.005);  // half of the pair's relative pitch
  EXPECT_NEAR(pair.camera.fx, P1.at<double>(0, 0), 0.05 * pair.camera.fx);
  EXPECT_NEAR(pair.camera.bf(), -P2.at<double>(0, 3), 0.05 * pair.camera.bf());
}

// Independent of the implementation: 3D points project to equal rows in both images, with disparity
// bf / z.
void ExpectRowsAndDisparities(const RawCamera& left, const RawCamera& right,
                              const Se3& T_left_right) {
  const RectifiedPair pair = RectifyStereo(left, right, T_left_right);
  int seen = 0;
  for (int v = 5; v < pair.camera.height; v += 23) {
    for (int u = 5; u < pair.camera.width; u += 29) {
      const double z = 0.5 + 0.01 * ((u * 7 + v * 13) % 400);
      const Eigen::Vector3d p_rectified = pair.camera.Unproject(Eigen::Vector2d(u, v), z);
      const Eigen::Vector3d p_left = pair.R_left_rectified * p_rectified;
      EXPECT_LT((left.Project(p_left) - SourceOf(pair.left, u, v)).norm(), 0.05);
      const double u_right = u - pair.camera.bf() / z;
      const int near = static_cast<int>(std::lround(u_right));
      if (near < 1 || near + 1 >= pair.camera.width) continue;
      const Eigen::Vector2d in_right = right.Project(T_left_right.Inverse() * p_left);
      // Interpolates the map between the pixels next to u_right.
      const int floor = static_cast<int>(std::floor(u_right));
      const double part = u_right - floor;
      const Eigen::Vector2d mapped =
          (1 - part) * SourceOf(pair.right, floor, v) + part * SourceOf(pair.right, floor + 1, v);
      EXPECT_LT((in_right - mapped).norm(), 0.06) << u << " " << v;
      ++seen;
    }
  }
  EXPECT_GT(seen, 100);
}

TEST(RectifyStereo, PutsPointsOnEqualRowsWithTheirDisparity) {
  ExpectRowsAndDisparities(EurocLeft(), EurocRight(), CrookedPair());
  ExpectRowsAndDisparities(Fisheye(), Fisheye(), CrookedPair());
}

TEST(RectifyStereo, LeavesNoBlackBorders) {
  const RectifiedPair pair = RectifyStereo(EurocLeft(), EurocRight(), CrookedPair());
  const cv::Mat white(480, 752, CV_8UC1, cv::Scalar(255));
  EXPECT_EQ(cv::countNonZero(pair.left.Apply(white) != 255), 0);
  EXPECT_EQ(cv::countNonZero(pair.right.Apply(white) != 255), 0);
}

TEST(RectifyStereo, OfCamerasThatAreNoPairIsAnError) {
  EXPECT_THROW(RectifyStereo(EurocLeft(), EurocRight(), CrookedPair().Inverse()), Error);
  EXPECT_THROW(RectifyStereo(EurocLeft(), EurocRight(), Se3{}), Error);
  EXPECT_THROW(RectifyStereo(EurocLeft(), Fisheye(), CrookedPair()), Error);
}

TEST(RectifyOne, MakesAPinholeOfAFisheye) {
  const RectifiedCamera one = RectifyOne(Fisheye());
  EXPECT_FALSE(one.camera.HasDistortion());
  EXPECT_EQ(one.camera.fx, one.camera.fy);
  for (int v = 0; v < one.camera.height; v += 21) {
    for (int u = 0; u < one.camera.width; u += 17) {
      const Eigen::Vector3d p = one.camera.Unproject(Eigen::Vector2d(u, v), 2);
      EXPECT_LT((Fisheye().Project(p) - SourceOf(one.map, u, v)).norm(), 0.05);
    }
  }
  const cv::Mat white(400, 512, CV_8UC1, cv::Scalar(255));
  EXPECT_EQ(cv::countNonZero(one.map.Apply(white) != 255), 0);
  // Half of the width spans at most half of 110 degrees.
  EXPECT_GE(one.camera.fx * std::tan(55 * M_PI / 180) + 1, one.camera.width / 2.0);
}

TEST(RectifyMap, NearestRoundsAndNeverBlends) {
  const RectifiedCamera one = RectifyOne(Fisheye());
  cv::Mat index(400, 512, CV_32FC1);
  for (int y = 0; y < index.rows; ++y) {
    for (int x = 0; x < index.cols; ++x) index.at<float>(y, x) = static_cast<float>(1000 * y + x);
  }
  const cv::Mat out = one.map.ApplyNearest(index);
  for (int v = 3; v < 400; v += 31) {
    for (int u = 3; u < 512; u += 37) {
      const Eigen::Vector2d from = SourceOf(one.map, u, v);
      const int value = static_cast<int>(out.at<float>(v, u));
      EXPECT_LE(std::abs(value % 1000 - from.x()), 0.54);
      EXPECT_LE(std::abs(value / 1000 - from.y()), 0.54);
    }
  }
}

}  // namespace
}  // namespace alidade::rectify_test
