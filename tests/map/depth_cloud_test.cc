#include "alidade/map/depth_cloud.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <tuple>

namespace alidade::depth_cloud_test {
namespace {

Camera TestCamera() { return Camera::FromFieldOfView(64, 48, 60); }

// The plane n·p = d in the world frame.
struct Plane {
  Eigen::Vector3d n = Eigen::Vector3d(0.2, -0.1, 1).normalized();
  double d = 2;
};

// Exact depth of the plane in a camera at `T_world_camera`, at every `step` pixels.
DepthMap Measure(const Plane& plane, const Camera& camera, const Se3& T_world_camera,
                 float relative_sigma = 0.01f, int step = 1) {
  DepthMap depth;
  depth.width = camera.width;
  depth.height = camera.height;
  for (int y = 0; y < camera.height; y += step) {
    for (int x = 0; x < camera.width; x += step) {
      const Eigen::Vector3d ray = T_world_camera.R * camera.Unproject({x, y});
      const double z = (plane.d - plane.n.dot(T_world_camera.t)) / plane.n.dot(ray);
      const auto inverse = static_cast<float>(1 / z);
      depth.pixels.push_back({static_cast<uint16_t>(x),
                              static_cast<uint16_t>(y),
                              inverse,
                              relative_sigma * inverse,
                              {static_cast<uint8_t>(x), static_cast<uint8_t>(y), 7}});
    }
  }
  return depth;
}

Se3 Pose(const Vector6d& xi) { return Se3::Exp(xi); }
const Se3 kHere = Pose((Vector6d() << 0.1, 0, -0.2, 0.05, -0.1, 0.02).finished());
const Se3 kThere = Pose((Vector6d() << -0.6, 0.2, 0.1, -0.1, 0.3, 0.1).finished());

TEST(DepthCloud, OfAPlaneSeenTwiceLiesOnThePlane) {
  const Plane plane;
  const Camera camera = TestCamera();
  const DepthMap here = Measure(plane, camera, kHere), there = Measure(plane, camera, kThere);
  for (const double voxel : {0.0, 0.05}) {
    const Cloud cloud = MakeDepthCloud({{&here, kHere, 1}, {&there, kThere, 1}}, camera, voxel);
    ASSERT_GT(cloud.points.size(), 100u);
    for (const Eigen::Vector3f& p : cloud.points)
      EXPECT_NEAR(plane.n.dot(p.cast<double>()), plane.d, 1e-5);
    if (voxel == 0) {
      EXPECT_EQ(cloud.points.size(), 2u * 64 * 48);
    }
  }
}

using Cube = std::tuple<long, long, long>;
Cube CubeOf(const Eigen::Vector3f& p, double edge) {
  const auto at = [&](int axis) { return std::lround(std::floor(double{p[axis]} / edge)); };
  return {at(0), at(1), at(2)};
}

TEST(DepthCloud, VoxelsHoldOnePointEachAndAllThatWereMet) {
  const Camera camera = TestCamera();
  // Planes that are not within float precision of a voxel face.
  const DepthMap here = Measure({}, camera, kHere), there = Measure({}, camera, kThere);
  const std::vector<PlacedDepth> both = {{&here, kHere, 1}, {&there, kThere, 1}};
  constexpr double kEdge = 0.07;
  std::map<Cube, int> all, kept;
  for (const auto& p : MakeDepthCloud(both, camera, 0).points) ++all[CubeOf(p, kEdge)];
  for (const auto& p : MakeDepthCloud(both, camera, kEdge).points) ++kept[CubeOf(p, kEdge)];
  EXPECT_LT(kept.size(), 64u * 48);  // points were merged
  EXPECT_EQ(kept.size(), all.size());
  for (const auto& [cube, count] : kept) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(all.count(cube), 1u);
  }
}

TEST(DepthCloud, PointOfAVoxelIsTheMeanByInverseVariance) {
  const Camera camera = TestCamera();
  DepthMap depth;
  // Two depths along one ray: 1.000 and 1.004 m with sigmas of 1 and 2 cm (z² σ_ρ).
  const auto x = static_cast<uint16_t>(32), y = static_cast<uint16_t>(24);
  depth.pixels = {{x, y, 1.f, 0.01f, {100, 0, 0}},
                  {x, y, 1 / 1.004f, 0.02f / 1.004f / 1.004f, {200, 0, 50}}};
  const Cloud cloud = MakeDepthCloud({{&depth, {}, 1}}, camera, 1.5);
  ASSERT_EQ(cloud.points.size(), 1u);
  EXPECT_NEAR(cloud.points[0].z(), (4 * 1.0 + 1 * 1.004) / 5, 1e-6);
  EXPECT_EQ(cloud.colors[0], (std::array<uint8_t, 3>{120, 0, 10}));
  const double stretch = camera.Unproject({x, y}).norm();  // along the ray, not along z
  EXPECT_NEAR(cloud.sigmas[0], stretch * 0.01 / std::sqrt(1 + 0.25), 1e-7);
}

TEST(DepthCloud, SigmaIsHowFarOneOfInverseDepthMovesThePoint) {
  const Camera camera = TestCamera();
  DepthMap depth;
  depth.pixels = {{5, 40, 0.4f, 1e-4f, {}}, {5, 40, 0.4001f, 1e-4f, {}}};
  const Cloud cloud = MakeDepthCloud({{&depth, kThere, 1.7}}, camera, 0);
  ASSERT_EQ(cloud.points.size(), 2u);
  const double moved = (cloud.points[1] - cloud.points[0]).norm();
  EXPECT_NEAR(cloud.sigmas[0], moved, 1e-3 * moved);  // up to second order
}

TEST(DepthCloud, LengthsFollowTheKeyFramesScale) {
  const Camera camera = TestCamera();
  KeyFrame keyframe;
  auto depth = std::make_shared<DepthMap>(Measure({}, camera, {}));
  depth->scale = 0.5;
  keyframe.depth = depth;
  keyframe.scale = 2;
  keyframe.T_camera_world = kHere.Inverse();
  const Cloud then = MakeDepthCloud({{depth.get(), {}, 1}}, camera, 0);
  const Cloud now = MakeDepthCloud({PlaceDepth(keyframe)}, camera, 0);
  ASSERT_EQ(now.points.size(), then.points.size());
  for (size_t i = 0; i < now.points.size(); ++i) {
    const Eigen::Vector3d expected = kHere * (4.0 * then.points[i].cast<double>());
    EXPECT_LT((now.points[i].cast<double>() - expected).norm(), 1e-5);
    EXPECT_NEAR(now.sigmas[i], 4 * then.sigmas[i], 1e-6);
  }
}

TEST(DepthCloud, LeavesOutWhatIsNoDepth) {
  DepthMap depth;
  depth.pixels = {{1, 1, 0.f, 0.1f, {}}, {2, 1, -1.f, 0.1f, {}}, {3, 1, NAN, 0.1f, {}}};
  for (const double voxel : {0.0, 0.01}) {
    EXPECT_TRUE(MakeDepthCloud({{&depth, {}, 1}}, TestCamera(), voxel).points.empty());
  }
  EXPECT_EQ(cv::countNonZero(DrawDepth(depth, 1, TestCamera())), 0);
}

TEST(DepthPicture, IsRegisteredToTheImageAsTaken) {
  Camera camera = TestCamera();
  camera.cx = 30;
  camera.cy = 20;
  camera.distortion = {-0.3, 0, 0, 0, 0};
  DepthMap depth;
  depth.pixels = {{60, 20, 0.5f, 0.01f, {}}, {30, 20, 0.25f, 0.01f, {}}};
  const cv::Mat picture = DrawDepth(depth, 1, camera);
  EXPECT_EQ(picture.type(), CV_16UC1);
  EXPECT_EQ(picture.size(), cv::Size(64, 48));
  EXPECT_EQ(cv::countNonZero(picture), 2);
  const double x = 30 / camera.fx;  // Brown's model on the x axis, computed by hand
  const int taken = static_cast<int>(std::lround(30 + camera.fx * x * (1 - 0.3 * x * x)));
  ASSERT_LT(taken, 59);  // the distortion is visible
  EXPECT_EQ(picture.at<uint16_t>(20, taken), 10000);
  EXPECT_EQ(picture.at<uint16_t>(20, 30), 20000);  // the principal point is not displaced
}

TEST(DepthPicture, TheNearerHoldsAndTheFarIsLeftOut) {
  const Camera camera = TestCamera();
  DepthMap depth;
  depth.pixels = {{10, 9, 1 / 3.f, 0.01f, {}},  {10, 9, 1 / 2.f, 0.01f, {}},
                  {10, 9, 1 / 4.f, 0.01f, {}},  {12, 9, 1 / 6.5f, 0.01f, {}},
                  {14, 9, 1 / 6.6f, 0.01f, {}}, {700, 9, 1.f, 0.01f, {}}};
  const cv::Mat picture = DrawDepth(depth, 2, camera);  // a loop closure doubled all lengths
  EXPECT_EQ(picture.at<uint16_t>(9, 10), 20000);
  EXPECT_EQ(picture.at<uint16_t>(9, 12), 65000);
  EXPECT_EQ(picture.at<uint16_t>(9, 14), 0);  // 13.2 m is beyond the range of 13.1 m
  EXPECT_EQ(cv::countNonZero(picture), 2);
}

}  // namespace
}  // namespace alidade::depth_cloud_test
