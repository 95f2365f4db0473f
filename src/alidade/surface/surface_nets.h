// The surface of a field of signed distances as triangles.
#pragma once

#include "alidade/surface/mesh.h"
#include "alidade/surface/voxel_blocks.h"

namespace alidade {

struct SurfaceNetsSettings {
  double voxel = 0.02;    // edge length, meters
  double min_weight = 1;  // of voxels with a surface between them
};

// Naive surface nets (Gibson 1998): each cube of 8 voxel centers that the surface passes through
// gets one vertex, the mean of the points where it cuts the cube's edges; each cut edge joins the
// vertices of its four cubes. The normal is the gradient of the distance. Cubes with a voxel that
// weighs less than `min_weight` are left open. The result does not depend on the number of threads.
Mesh MakeSurfaceNets(const VoxelBlocks& blocks, const SurfaceNetsSettings& settings);

}  // namespace alidade
