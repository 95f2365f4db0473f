// A whole run: from what was asked for to the files it leaves behind.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "alidade/run/outputs.h"
#include "alidade/run/play/watcher.h"
#include "alidade/run/setup/options.h"

namespace alidade {

struct RunOutcome {
  RunSummary summary;
  RunSetup setup;
  CameraFinding camera;
  RunLog log;
  std::string folder;  // where the results are
  // Exit status of a program that ends with it: 0, or 130 when it was interrupted. All else is
  // thrown.
  int status = 0;
};

// A part of the system stopped, by no fault of the recording's: it had no memory left, or has a
// bug. What could be done without is written.
class RunStopped : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Opens the source, plays it, writes the results. Throws Error (see ErrorKind) for what cannot be,
// RunStopped (after everything else was done), and whatever else is a bug of ours.
RunOutcome Run(const RunOptions& options, const std::vector<RunWatcher*>& watchers);

}  // namespace alidade
