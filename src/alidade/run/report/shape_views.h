// Images of the semi-dense point cloud.
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
  CloudScene scene;  // about as many points as an image of it has pixels
  std::vector<ReportPicture> pictures;
};

// semidense.png, and further views for the report. `cloud`: semi-dense cloud of the first map, with
// that voxel size (0: all points). Throws Error (input) if the file cannot be written.
ShapeViews WriteShapeViews(OutputFolder& folder, const RunResults& results, const Camera& camera,
                           const Cloud& cloud, double voxel);

// The landmarks of the first map, and an image of them.
ShapeViews LandmarkViews(const RunResults& results, Cloud landmarks);

}  // namespace alidade
