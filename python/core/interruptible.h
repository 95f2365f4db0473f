// Runs long work that Ctrl-C can interrupt.
#pragma once

#include <functional>

namespace alidade::python {

// Runs `work` in a separate thread and returns when it is done; rethrows its exception. Must be
// called with the GIL, which is released meanwhile and acquired 20 times per second for Python's
// signal handlers and for `meanwhile`, which may be empty. When these raise (KeyboardInterrupt),
// calls `interrupt`, each time, and rethrows the first exception after `work` has ended. `work`
// must acquire the GIL to use Python.
void WorkInterruptibly(const std::function<void()>& work, const std::function<void()>& interrupt,
                       const std::function<void()>& meanwhile = {});

}  // namespace alidade::python
