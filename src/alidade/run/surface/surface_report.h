// The grid and the mesh of a result in its report.
#pragma once

#include <string>

#include "alidade/run/surface/surface_results.h"

namespace alidade {

// The picture of the grid with the camera's path over it. `words`: how it was made.
void ShowInReport(const std::string& folder, const GridResult& grid, const std::string& words);
// The vertices, which can be turned, and an image of them.
void ShowInReport(const std::string& folder, const MeshResult& mesh, const std::string& words);

}  // namespace alidade
