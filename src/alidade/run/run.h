// A whole run: from its options to the result files.
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
  // Exit status of the program: 0, or 130 if interrupted. All other cases are exceptions.
  int status = 0;
};

// A part of the system stopped because of a bug or exhausted memory. The results obtained without
// it are written.
class RunStopped : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Opens the source, plays it and writes the results. Throws Error (see ErrorKind) for invalid
// options and input, RunStopped (after everything else was done), and other exceptions for bugs.
RunOutcome Run(const RunOptions& options, const std::vector<RunWatcher*>& watchers);

}  // namespace alidade
