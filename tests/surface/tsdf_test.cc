#include "alidade/surface/tsdf.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "alidade/base/error.h"
#include "alidade/base/parallel.h"
#include "problems/surface_truth.h"
#include "support/dense_views.h"
#include "support/expect_error.h"

namespace alidade::tsdf_test {
namespace {

Mesh MeshOf(const std::vector<DenseView>& views, const TsdfSettings& settings = {}) {
  Tsdf tsdf(settings);
  for (const DenseView& view : views) tsdf.Add(view);
  return tsdf.MakeMesh();
}

// Distances of vertices to the true surface, sorted, meters.
std::vector<double> Distances(const Mesh& mesh, const SynthSettings& settings) {
  const SurfaceTruth truth(settings);
  std::vector<double> distances;
  const size_t step = std::max<size_t>(1, mesh.vertices.points.size() / 3000);
  for (size_t i = 0; i < mesh.vertices.points.size(); i += step)
    distances.push_back(truth.Distance(mesh.vertices.points[i].cast<double>()));
  std::sort(distances.begin(), distances.end());
  return distances;
}

TEST(Tsdf, MakesAPlaneOfAPlane) {
  DenseView view = FlatView(1.5);
  view.color = cv::Mat3b(view.depth.size(), cv::Vec3b(10, 100, 200));  // blue, green, red
  const Mesh mesh = MeshOf({view});
  ASSERT_GT(mesh.triangles.size(), 1000u);
  for (size_t i = 0; i < mesh.vertices.points.size(); ++i) {
    EXPECT_NEAR(mesh.vertices.points[i].z(), 1.5, 1e-4);
    EXPECT_LT(mesh.vertices.normals[i].z(), -0.99);  // towards the camera
    EXPECT_EQ(mesh.vertices.colors[i], (std::array<uint8_t, 3>{200, 100, 10}));
  }
  for (const auto& [a, b, c] : mesh.triangles) {  // counterclockwise as the camera sees them
    const auto& p = mesh.vertices.points;
    EXPECT_LT((p[b] - p[a]).cross(p[c] - p[a]).z(), 0);
  }
}

TEST(Tsdf, WeighsReadingsByTheInverseOfTheirVariance) {
  DenseView sure = FlatView(1.50), unsure = FlatView(1.53);
  unsure.inverse_sigma = 2 * sure.inverse_sigma * (1.50 * 1.50) / (1.53 * 1.53);  // a quarter
  const Mesh mesh = MeshOf({sure, unsure});
  for (const Eigen::Vector3f& p : mesh.vertices.points) EXPECT_NEAR(p.z(), 1.506, 0.001);
}

TEST(Tsdf, WhatALaterViewSeesThroughIsGone) {
  const DenseView near = FlatView(1.0), far = FlatView(1.5);
  const Mesh mesh = MeshOf({near, far, far, far, far, far, far});
  for (const Eigen::Vector3f& p : mesh.vertices.points) EXPECT_GT(p.z(), 1.4);
}

TEST(Tsdf, LeavesOutWhatIsUncertain) {
  DenseView view = FlatView(3);
  view.inverse_sigma = 0.05 / 9;  // 5 cm at 3 m: more than two voxels
  EXPECT_TRUE(MeshOf({view}).triangles.empty());
  TsdfSettings coarse;
  coarse.voxel = 0.05;
  EXPECT_FALSE(MeshOf({view}, coarse).triangles.empty());
}

TEST(Tsdf, RoomOfADepthCameraLiesWithinACentimeter) {
  const SynthSettings settings = SynthDefaults("room");
  const SynthRecording recording(settings);
  const Mesh mesh = MeshOf(DenseViewsOf(recording, 40, DepthOf::kSensor));
  const std::vector<double> distances = Distances(mesh, settings);
  EXPECT_LT(distances[distances.size() / 2], 0.01);
  EXPECT_LT(distances[distances.size() * 9 / 10], 0.04);
}

TEST(Tsdf, RoomOfAStereoPairLiesWithinThreeCentimeters) {
  SynthSettings settings = SmallRoom(true);
  const SynthRecording recording(settings);
  TsdfSettings coarse;
  coarse.voxel = 0.05;
  const Mesh mesh = MeshOf(DenseViewsOf(recording, 30, DepthOf::kStereo), coarse);
  ASSERT_GT(mesh.triangles.size(), 5000u);
  const std::vector<double> distances = Distances(mesh, settings);
  EXPECT_LT(distances[distances.size() / 2], 0.03);
}

TEST(Tsdf, IsTheSameWithAnyNumberOfThreads) {
  const SynthRecording recording(SmallRoom());
  const std::vector<DenseView> views = {DenseViewOf(recording, 0, DepthOf::kSensor),
                                        DenseViewOf(recording, 20, DepthOf::kSensor)};
  SetThreadCount(1);
  const Mesh one = MeshOf(views);
  SetThreadCount(3);
  const Mesh three = MeshOf(views);
  SetThreadCount(0);
  EXPECT_EQ(one.triangles, three.triangles);
  EXPECT_EQ(one.vertices.points, three.vertices.points);
  EXPECT_EQ(one.vertices.colors, three.vertices.colors);
}

TEST(Tsdf, RefusesSettingsThatCannotBe) {
  TsdfSettings settings;
  settings.voxel = 0;
  EXPECT_NE(MessageOf(ErrorKind::kUsage, [&] { Tsdf{settings}; }).find("voxel"), std::string::npos);
}

}  // namespace
}  // namespace alidade::tsdf_test
