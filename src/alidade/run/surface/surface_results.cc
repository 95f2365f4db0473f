#include "alidade/run/surface/surface_results.h"

#include <vector>

#include "alidade/base/error.h"
#include "alidade/ros/robot_frames.h"
#include "alidade/view/upright.h"

namespace alidade {
namespace {

constexpr double kStereoVoxel = 0.04;  // meters: its depth has three times the error of a sensor's

Eigen::Matrix3d UprightOf(const ViewWorld& world) {
  return UprightAxes({world.path},
                     world.up ? std::optional<Eigen::Vector3d>(-*world.up) : std::nullopt);
}

// Rows: x, y and z of glTF, where y is up and z comes towards the viewer.
Eigen::Matrix3d GltfAxes(const ViewWorld& world) {
  const Eigen::Matrix3d axes = UprightOf(world);  // right, forward, up
  Eigen::Matrix3d gltf;
  gltf << axes.row(0), axes.row(2), -axes.row(1);
  return gltf;
}

Floor FloorFor(const std::string& path, const std::vector<DenseView>& views, const ViewWorld& world,
               const GridSettings& settings) {
  const Eigen::Vector3d up = UprightOf(world).row(2);
  if (settings.camera_height) {
    Floor floor;
    floor.up = up;
    floor.height = up.dot(world.path.front().t) - *settings.camera_height;
    return floor;
  }
  const auto floor = FindFloor(views, up);
  if (!floor)
    ThrowInput(path +
               ": no floor was seen: the lowest large level plane below the camera. Give the "
               "height of the camera above the floor with --camera-height");
  return *floor;
}

// A world with z up (aligned by a survey, exported) keeps its axes; else those of the robot's base
// at the first frame are levelled.
Se3 FrameOf(const Floor& floor, const std::optional<Se3>& T_base_camera) {
  constexpr double kLevel = 0.985;  // cosine of 10°
  if (!T_base_camera && floor.up.z() > kLevel)
    return floor.FrameFor(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX());
  const Se3 T_world_base = T_base_camera.value_or(CameraAtBase()).Inverse();
  return floor.FrameFor(T_world_base.t, T_world_base.R.col(0));
}

}  // namespace

MeshResult MakeMesh(const std::string& path, const MeshSettings& settings,
                    const ExportProgress& progress) {
  const SavedMap saved = ReadSavedMap(path);
  if (saved.sensor == NameOf(Sensor::kMono))
    ThrowUsage(path + " is of one camera: a mesh needs the depth of a sensor or of a stereo pair");
  MeshSettings how = settings;
  if (!how.voxel_given && saved.sensor == NameOf(Sensor::kStereo)) how.tsdf.voxel = kStereoVoxel;
  how.views.color = true;
  Tsdf tsdf(how.tsdf);
  MeshResult result;
  result.voxel = how.tsdf.voxel;
  result.views = ForEachDenseView(path, saved, how.views, progress,
                                  [&](const DenseView& view) { tsdf.Add(view); });
  result.bytes = tsdf.bytes();
  result.mesh = tsdf.MakeMesh();
  result.R_up = GltfAxes(result.views.world);
  if (result.mesh.triangles.empty())
    ThrowInput(path + ": its depth makes no surface; try larger voxels (--voxel)");
  return result;
}

GridResult MakeGrid(const std::string& path, const GridSettings& settings,
                    const ExportProgress& progress) {
  const SavedMap saved = ReadSavedMap(path);
  std::vector<DenseView> views;
  GridResult result;
  result.views = ForEachDenseView(path, saved, settings.views, progress,
                                  [&](const DenseView& view) { views.push_back(view); });
  result.floor = FloorFor(path, views, result.views.world, settings);
  result.T_grid_world = FrameOf(result.floor, settings.T_base_camera);
  OccupancyMap map(settings.occupancy, result.T_grid_world);
  for (const DenseView& view : views) map.Add(view);
  result.picture = map.Picture();
  if (result.picture.cells.empty())
    ThrowInput(path + ": no cell of the floor is known; try larger ones (--cell)");
  return result;
}

}  // namespace alidade
