// Triangles with normals and colors, and their files.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "alidade/io/cloud.h"

namespace alidade {

struct Mesh {
  // Vertices with normals, which point to the side the surface was seen from; colors may be empty.
  Cloud vertices;
  // Indices of vertices, counterclockwise as seen from that side.
  std::vector<std::array<uint32_t, 3>> triangles;
};

// PLY, binary little endian: vertices as EncodePly() writes clouds, and `vertex_indices`.
std::string EncodeMeshPly(const Mesh& mesh);

// glTF 2.0 binary (GLB): one mesh, unlit, since recorded colors contain the light. `R_up`: from the
// mesh's world to axes with y up, as glTF demands: the rotation of the mesh's node; the vertices
// stay in their world. Throws Error (usage) for a mesh without triangles, which glTF does not
// allow, and for one that exceeds the format's 4 GiB.
std::string EncodeGlb(const Mesh& mesh, const Eigen::Matrix3d& R_up);

}  // namespace alidade
