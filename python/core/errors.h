// Passes the library's errors and warnings to Python.
#pragma once

#include <string>

#include "alidade/base/error.h"

namespace alidade::python {

// An array of a type or shape that its argument cannot have; alidade.ArrayError in Python.
class ArrayError : public Error {
 public:
  explicit ArrayError(const std::string& message) : Error(ErrorKind::kInput, message) {}
};

// Collects the library's warnings in a list, which the package passes to `logging` between two
// calls. Warnings come from any thread; acquiring the GIL for each could deadlock with a thread
// that holds a lock. Must be called again after a run, which installs its own listener.
void CollectWarnings();
void KeepWarning(const std::string& message);  // any thread

}  // namespace alidade::python
