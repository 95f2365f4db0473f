// Meshes and floor grids of rendered recordings beside the true scene.
#pragma once

#include <string>
#include <vector>

#include "bench/measure/result.h"

namespace alidade::bench {

struct SurfaceOptions {
  std::vector<std::string> scenes;
  int seeds = 2;
  int frames = 600;
  std::string out;
};

int BenchSurface(const SurfaceOptions& options);

}  // namespace alidade::bench
