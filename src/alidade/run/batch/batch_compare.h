// Chooses the runs of a batch's compare.html: its own, and those of an earlier batch.
#pragma once

#include <string>
#include <vector>

#include "alidade/run/batch/batch_table.h"
#include "alidade/run/report/comparison.h"

namespace alidade {

// An earlier batch to compare with.
struct EarlierBatch {
  std::string folder;
  std::vector<BatchRow> rows;
};

// `path`: the folder of the batch or its batch.json. Throws Error (input) if it cannot be read.
EarlierBatch ReadEarlierBatch(const std::string& path);

struct BatchComparison {
  std::vector<ComparedFolder> runs;
  std::vector<std::string> missing;  // "desk: why it is not compared"
};

// All runs of `folder` that have a map, in the order of `rows`. With `earlier` (may be null), each
// run follows the earlier run of the same name, and both are named FOLDER/NAME. Runs of one batch
// only, and those whose folder no longer exists, are listed in `missing`.
BatchComparison RunsToCompare(const std::string& folder, const std::vector<BatchRow>& rows,
                              const EarlierBatch* earlier);

}  // namespace alidade
