// Which parts of the system work, and why one does not any more.
#pragma once

#include <exception>
#include <string>
#include <vector>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

// One part beside the tracker: "mapping", "loop closing", "full adjustment", "semi-dense mapping",
// "dynamics", "detector"; those that were asked for.
struct StageHealth {
  std::string name;
  bool running = true;
  std::string failure;  // what it threw, when it stopped; it does nothing from then on
  bool bug = false;     // what it threw is no Error: the fault is not in what it was given
  int backlog = 0;      // keyframes that wait for it
};
// `failure`: null when it runs.
StageHealth HealthOf(const char* name, const std::exception_ptr& failure, int backlog);

struct SlamHealth {
  std::vector<StageHealth> stages;
  bool ok() const;              // all of them run
  std::string Stopped() const;  // "mapping stopped: out of memory; …"; empty when all run
};

// What an exception says: its text, "out of memory", or "unknown exception".
std::string WhatOf(const std::exception_ptr& exception);

}  // namespace alidade
