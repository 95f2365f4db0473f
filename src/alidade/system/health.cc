#include "alidade/system/health.h"

#include <algorithm>
#include <new>

#include "alidade/base/error.h"

namespace alidade {

StageHealth HealthOf(const char* name, const std::exception_ptr& failure, int backlog) {
  StageHealth health{name, !failure, {}, false, backlog};
  if (!failure) return health;
  health.failure = WhatOf(failure);
  try {
    std::rethrow_exception(failure);
  } catch (const Error&) {
  } catch (...) {
    health.bug = true;
  }
  return health;
}

bool SlamHealth::ok() const {
  return std::all_of(stages.begin(), stages.end(),
                     [](const StageHealth& stage) { return stage.running; });
}

std::string SlamHealth::Stopped() const {
  std::string all;
  for (const StageHealth& stage : stages) {
    if (stage.running) continue;
    all += (all.empty() ? "" : "; ") + stage.name + " stopped: " + stage.failure;
  }
  return all;
}

std::string WhatOf(const std::exception_ptr& exception) {
  try {
    std::rethrow_exception(exception);
  } catch (const std::bad_alloc&) {
    return "out of memory";
  } catch (const std::exception& error) {
    return error.what();
  } catch (...) {
    return "unknown exception";
  }
}

}  // namespace alidade
