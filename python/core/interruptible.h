// Long work that Ctrl-C ends.
#pragma once

#include <functional>

namespace alidade::python {

// Does `work` in a thread of its own and returns when it is done; what it throws is thrown here.
// Called with the GIL, which is given up meanwhile: it is taken 20 times a second for Python's
// signal handlers, and for `meanwhile`, which may be empty. What these raise (KeyboardInterrupt)
// calls `interrupt`, again the second time, and is thrown once `work` has come to its end. `work`
// itself must take the GIL for whatever it does with Python.
void WorkInterruptibly(const std::function<void()>& work, const std::function<void()>& interrupt,
                       const std::function<void()>& meanwhile = {});

}  // namespace alidade::python
