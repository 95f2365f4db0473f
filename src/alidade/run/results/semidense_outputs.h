// What semi-dense mapping leaves behind (docs/guides/shape.md): depth pictures of the keyframes,
// their lists, and clouds.
#pragma once

#include "alidade/map/depth_cloud.h"
#include "alidade/run/folder/output_folder.h"
#include "alidade/run/results/run_results.h"

namespace alidade {

// The depth there is of one map's keyframes, in the world of its files. Points into `results`.
std::vector<PlacedDepth> DepthOf(const RunResults& results, const MapResults& map);

// depth/STAMP.png, depth.txt and semidense.ply; of further maps depth.1.txt, … Maps without depth
// leave nothing. Returns the cloud of the first map. Throws Error (input) when a file cannot be
// written; no depth picture stays that is on no list.
Cloud WriteSemiDense(OutputFolder& folder, const RunResults& results, const Camera& camera,
                     double voxel);

}  // namespace alidade
