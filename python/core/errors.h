// What goes wrong in C++, for Python.
#pragma once

#include <string>

namespace alidade::python {

// From now on the library's warnings wait in a list, which the package hands to `logging` between
// two calls. They come from any thread; to take the GIL for each would let a thread that holds a
// lock wait for one that wants it. Called anew after a run, which listens for itself.
void CollectWarnings();
void KeepWarning(const std::string& message);  // any thread

}  // namespace alidade::python
