// A run in numbers: stats.json and report.html.
#pragma once

#include <string>
#include <vector>

#include "alidade/view/report.h"
#include "run_record.h"
#include "run_results.h"

namespace alidade {

// Both as the bytes of the file. Fields and units: docs/formats.md.
std::string StatsJson(const RunRecord& record, const RunResults& results);
std::string ReportHtml(const RunRecord& record, const RunResults& results,
                       const std::vector<ReportPicture>& shape);

}  // namespace alidade
