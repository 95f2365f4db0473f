// Which parts of the system run, and why a part stopped.
#pragma once

#include <exception>
#include <string>
#include <vector>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

// One part beside the tracker: "mapping", "loop closing", "full adjustment", "semi-dense mapping",
// "dynamics" or "detector". Only parts in use are listed.
struct StageHealth {
  std::string name;
  bool running = true;
  std::string failure;  // text of the exception that stopped it; it does nothing from then on
  bool bug = false;     // the exception was not an Error: a defect of the program, not bad input
  int backlog = 0;      // keyframes that are queued or in progress
};
// `failure`: the exception that stopped the part; null: it runs.
StageHealth HealthOf(const char* name, const std::exception_ptr& failure, int backlog);

struct SlamHealth {
  std::vector<StageHealth> stages;
  bool ok() const;              // all parts run
  std::string Stopped() const;  // "mapping stopped: out of memory; …"; empty if all parts run
};

// Text of an exception: what(), "out of memory", or "unknown exception".
std::string WhatOf(const std::exception_ptr& exception);

}  // namespace alidade
