// A run in numbers: stats.json and report.html.
#pragma once

#include <string>
#include <vector>

#include "alidade/run/record.h"
#include "alidade/run/results.h"
#include "alidade/view/report.h"

namespace alidade {

// Both as the bytes of the file. Fields and units: docs/formats.md.
std::string StatsJson(const RunRecord& record, const RunResults& results);
std::string ReportHtml(const RunRecord& record, const RunResults& results,
                       const std::vector<ReportPicture>& shape);

}  // namespace alidade
