// A run as numbers: stats.json and report.html.
#pragma once

#include <string>
#include <vector>

#include "alidade/run/report/shape_views.h"
#include "alidade/run/results/record.h"
#include "alidade/run/results/run_results.h"
#include "alidade/view/report.h"

namespace alidade {

// What a report shows besides drawings. Empty parts are omitted.
struct ReportPictures {
  ShapeViews shape;
  std::vector<ReportKeyframe> keyframes;
};

// Content of both files. Keys and units: docs/reference/stats.md.
std::string StatsJson(const RunRecord& record, const RunResults& results);
std::string ReportHtml(const RunRecord& record, const RunResults& results, ReportPictures pictures);

}  // namespace alidade
