// A whole run: from what was asked for to the files it leaves behind.
#pragma once

#include <string>
#include <vector>

#include "alidade/run/options.h"
#include "alidade/run/outputs.h"
#include "alidade/run/watcher.h"

namespace alidade {

struct RunOutcome {
  RunSummary summary;
  RunRecord record;
  std::string folder;  // where the results are
  // Exit status of a program that ends with it: 0, or 130 when it was interrupted. All else is
  // thrown.
  int status = 0;
};

// Opens the source, plays it, writes the results. Throws Error (see ErrorKind) for what cannot be,
// and std::runtime_error for what is a bug of ours, after all that can be written was written;
// `watchers` were told where, then.
RunOutcome Run(const RunOptions& options, const std::vector<RunWatcher*>& watchers);

}  // namespace alidade
