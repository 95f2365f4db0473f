// Pictures of what semi-dense mapping found.
#pragma once

#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/io/cloud.h"
#include "alidade/run/folder/output_folder.h"
#include "alidade/run/results/run_results.h"
#include "alidade/view/cloud_picture.h"
#include "alidade/view/report.h"

namespace alidade {

struct ShapeViews {
  CloudScene scene;  // about as many points as there are pixels in a picture of it
  std::vector<ReportPicture> pictures;
};

// semidense.png, and the same with views from other sides for the report: of the first map's depth,
// whose cloud with that voxel (0: all points) is `cloud`. Throws Error (input) when it cannot be
// written.
ShapeViews WriteShapeViews(OutputFolder& folder, const RunResults& results, const Camera& camera,
                           const Cloud& cloud, double voxel);

// The first map's landmarks, and a picture of them.
ShapeViews LandmarkViews(const RunResults& results, Cloud landmarks);

}  // namespace alidade
