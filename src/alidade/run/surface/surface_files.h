// `alidade mesh` and `alidade grid`: writes the files.
#pragma once

#include <string>

#include "alidade/run/surface/surface_results.h"

namespace alidade {

// Write `out`.ply and `out`.glb; or, if `out` ends in .ply or .glb, that file alone. Empty:
// mesh.ply and mesh.glb in the result folder. Returns what was written, in words. Throws Error, as
// MakeMesh(); also usage for a place that cannot be.
std::string WriteMeshFiles(const std::string& path, const MeshSettings& settings,
                           const std::string& out, const ExportProgress& progress = {});

// Writes `out`.pgm and `out`.yaml; empty: map.pgm and map.yaml in the result folder. Otherwise as
// above.
std::string WriteGridFiles(const std::string& path, const GridSettings& settings,
                           const std::string& out, const ExportProgress& progress = {});

}  // namespace alidade
