// Writes the results of semi-dense mapping (docs/guides/shape.md): depth images of the keyframes,
// their lists, and point clouds.
#pragma once

#include "alidade/map/depth_cloud.h"
#include "alidade/run/folder/output_folder.h"
#include "alidade/run/results/run_results.h"

namespace alidade {

// Depth of the keyframes of one map, in the world of its files. Refers to `results`.
std::vector<PlacedDepth> DepthOf(const RunResults& results, const MapResults& map);

// Writes depth/STAMP.png, depth.txt and semidense.ply; for further maps depth.1.txt, … Maps without
// depth are skipped. Returns the cloud of the first map. Throws Error (input) if a file cannot be
// written; depth images without a list are removed then.
Cloud WriteSemiDense(OutputFolder& folder, const RunResults& results, const Camera& camera,
                     double voxel);

}  // namespace alidade
