// A run as numbers: stats.json and report.html.
#pragma once

#include <string>
#include <vector>

#include "alidade/run/calibration/camera_finding.h"
#include "alidade/run/report/shape_views.h"
#include "alidade/run/results/run_log.h"
#include "alidade/run/results/run_results.h"
#include "alidade/run/setup/run_setup.h"
#include "alidade/view/report.h"

namespace alidade {

// What a report shows besides drawings. Empty parts are omitted.
struct ReportPictures {
  ShapeViews shape;
  std::vector<ReportKeyframe> keyframes;
};

// Whether lengths of a map are meters.
bool IsMetric(const RunSetup& setup, const MapResults& map);

// Both as the bytes of the file. Fields and units: docs/reference/stats.md.
std::string StatsJson(const RunSetup& setup, const CameraFinding& camera, const RunLog& log,
                      const RunResults& results);
// `folder`: of the result, as the user typed it.
std::string ReportHtml(const RunSetup& setup, const CameraFinding& camera, const RunLog& log,
                       const RunResults& results, const std::string& folder,
                       ReportPictures pictures);

}  // namespace alidade
