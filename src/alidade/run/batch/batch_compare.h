// Which runs a batch's compare.html shows: its own, and those of an earlier batch beside them.
#pragma once

#include <string>
#include <vector>

#include "alidade/run/batch/batch_table.h"
#include "alidade/run/report/comparison.h"

namespace alidade {

// Another batch to be held against this one.
struct EarlierBatch {
  std::string folder;
  std::vector<BatchRow> rows;
};

// `path`: its folder or its batch.json. Throws Error (input) when it cannot be read.
EarlierBatch ReadEarlierBatch(const std::string& path);

struct BatchComparison {
  std::vector<ComparedFolder> runs;
  std::vector<std::string> missing;  // "desk: why it is not beside"
};

// All of `folder` that were mapped, in the order of `rows`. `earlier` (may be null): each of its
// runs stands before the one of the same name, and both are called FOLDER/NAME; those that only one
// batch has, or whose folder is gone, are left out of it.
BatchComparison RunsToCompare(const std::string& folder, const std::vector<BatchRow>& rows,
                              const EarlierBatch* earlier);

}  // namespace alidade
