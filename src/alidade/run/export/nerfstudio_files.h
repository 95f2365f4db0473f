// The folder format of nerfstudio (Tancik et al. 2023; docs.nerf.studio, "Data conventions"):
// transforms.json and a point cloud.
#pragma once

#include <string>

#include "alidade/io/cloud.h"
#include "alidade/io/colmap.h"

namespace alidade {

// Rotation of the world: x stays right, y becomes forward and z up, if the first keyframe was
// upright; it is the `applied_transform` of nerfstudio's own converter.
Eigen::Matrix3d NerfstudioFromMap();

// transforms.json for images/NAME (and masks/NAME.png) and sparse_pc.ply. transform_matrix maps
// camera axes of OpenGL (x right, y up, z backwards) to the rotated world. cx and cy count from the
// corner of the image, as everywhere in nerfstudio.
std::string NerfstudioJson(const ColmapModel& model, bool masks);

// The points in the rotated world.
Cloud NerfstudioCloud(const ColmapModel& model);

}  // namespace alidade
