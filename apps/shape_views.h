// Pictures of what semi-dense mapping found.
#pragma once

#include <vector>

#include "alidade/view/cloud_picture.h"
#include "alidade/view/report.h"
#include "output_folder.h"

namespace alidade {

// semidense.png, and the same with views from other sides for the report. Throws Error (input) when
// it cannot be written.
std::vector<ReportPicture> WriteShapeViews(OutputFolder& folder, const CloudScene& scene);

}  // namespace alidade
