// `alidade mesh` and `alidade grid`: files made of the depth of a result.
#pragma once

#include <optional>
#include <string>

#include "alidade/run/surface/dense_views.h"
#include "alidade/surface/occupancy.h"
#include "alidade/surface/tsdf.h"

namespace alidade {

struct SurfaceSettings {
  DenseViewSettings views;
  // OUT of the command; empty: in the result folder.
  std::string out;
};

struct MeshSettings : SurfaceSettings {
  TsdfSettings tsdf;
  // Edge length of voxels is chosen for the sensor: 2 cm, with stereo 4 cm.
  bool voxel_given = false;
};

struct GridSettings : SurfaceSettings {
  OccupancySettings occupancy;
  // Of the camera on the robot, in the frame of its base; its origin and x axis at the first frame
  // become those of the grid, as in `alidade ros2`.
  std::optional<Se3> T_base_camera;
  // Height of the first camera above the floor, meters; without it the floor is looked for.
  std::optional<double> camera_height;
};

// Write `out`.ply and `out`.glb; or, if `out` ends in .ply or .glb, that file alone. Default:
// mesh.ply and mesh.glb in the result folder. Returns what was written, in words. Throws Error, as
// ForEachDenseView(); usage for a result of one camera.
std::string WriteMeshFiles(const std::string& path, const MeshSettings& settings,
                           const ExportProgress& progress = {});

// Writes `out`.pgm and `out`.yaml; default: map.pgm and map.yaml in the result folder. Otherwise as
// above; input if no floor is found.
std::string WriteGridFiles(const std::string& path, const GridSettings& settings,
                           const ExportProgress& progress = {});

}  // namespace alidade
