// What `alidade-bench dynamic` measured, as tables.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/dynamic/run.h"
#include "bench/measure/result.h"

namespace alidade::bench {

// One way to run, on every seed.
struct DynamicVariant {
  std::string name;  // a mode's, or what is left out
  std::vector<DynamicRun> runs;
  // Against the same frames without people, on the frames that both have a pose for: metres.
  std::vector<double> ate_here, ate_plain;
};

struct DynamicCase {
  Case of;                               // recording and sensor
  std::vector<DynamicVariant> variants;  // the first is `off`
  std::vector<DynamicRun> plain;         // off, without people
  Overlap detected_boxes, people_boxes;  // the boxes' area against the true masks
};

// RMSE and standard deviation of each mode, and what it improves on `off`.
std::vector<Table> ErrorTables(const std::vector<DynamicCase>& cases);
Table CoverageTable(const std::vector<DynamicCase>& cases);
Table MaskTable(const std::vector<DynamicCase>& cases);
// No lines where nothing was run without people.
Table PlainTable(const std::vector<DynamicCase>& cases);
// All variants of one case, one in each row.
Table VariantTable(const std::string& name, const DynamicCase& of);
// Each run, one in each row.
Table RunTable(const std::vector<DynamicCase>& cases);

}  // namespace alidade::bench
