// A run in numbers: stats.json and report.html.
#pragma once

#include <string>

#include "run_record.h"
#include "run_results.h"

namespace alidade {

// Of the map with the most frames "trajectory.txt", of the next "trajectory.1.txt", and so on.
std::string NumberedFile(const std::string& name, size_t number);

// Both as the bytes of the file. Fields and units: docs/formats.md.
std::string StatsJson(const RunRecord& record, const RunResults& results);
std::string ReportHtml(const RunRecord& record, const RunResults& results);

}  // namespace alidade
