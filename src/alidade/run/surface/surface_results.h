// The mesh and the floor grid of a result.
#pragma once

#include <optional>
#include <string>

#include "alidade/run/surface/dense_views.h"
#include "alidade/surface/floor.h"
#include "alidade/surface/occupancy.h"
#include "alidade/surface/tsdf.h"

namespace alidade {

struct MeshSettings {
  DenseViewSettings views;
  TsdfSettings tsdf;
  // `tsdf.voxel` was chosen; false: 2 cm, with stereo 4 cm.
  bool voxel_given = false;
};

struct MeshResult {
  Mesh mesh;  // in the world of the result's files
  ViewSummary views;
  double voxel = 0;      // edge length, meters
  size_t bytes = 0;      // of the voxels
  Eigen::Matrix3d R_up;  // to axes with y up, as glTF has them
};

struct GridSettings {
  DenseViewSettings views;
  OccupancySettings occupancy;
  // Of the camera on the robot, in the frame of its base; its origin and x axis at the first frame
  // become those of the grid, as in `alidade ros2`.
  std::optional<Se3> T_base_camera;
  // Height of the first camera above the floor, meters; without it the floor is looked for.
  std::optional<double> camera_height;
};

struct GridResult {
  OccupancyPicture picture;
  Floor floor;
  Se3 T_grid_world;  // from the world of the result's files (lengths scaled) to that of the grid
  ViewSummary views;
};

// Read the recording once. `path`: a result folder or a map. Throw Error, as ForEachDenseView();
// also usage: a mesh of one camera; input: depth that makes no surface, no floor.
MeshResult MakeMesh(const std::string& path, const MeshSettings& settings,
                    const ExportProgress& progress = {});
GridResult MakeGrid(const std::string& path, const GridSettings& settings,
                    const ExportProgress& progress = {});

}  // namespace alidade
