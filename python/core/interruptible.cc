#include "interruptible.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "python.h"

namespace alidade::python {

void WorkInterruptibly(const std::function<void()>& work, const std::function<void()>& interrupt,
                       const std::function<void()>& meanwhile) {
  constexpr std::chrono::milliseconds kTurn(50);
  std::mutex mutex;
  std::condition_variable changed;
  bool done = false;
  std::exception_ptr failure, raised;
  {
    const py::gil_scoped_release release;
    std::thread worker([&] {
      try {
        work();
      } catch (...) {
        failure = std::current_exception();
      }
      const std::lock_guard<std::mutex> lock(mutex);
      done = true;
      changed.notify_all();
    });
    while (true) {
      {
        std::unique_lock<std::mutex> lock(mutex);
        if (changed.wait_for(lock, kTurn, [&] { return done; })) break;
      }
      const py::gil_scoped_acquire acquire;
      try {
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        if (meanwhile && !raised) meanwhile();
      } catch (...) {
        if (!raised) raised = std::current_exception();  // keep the first one
        interrupt();
      }
    }
    worker.join();
  }
  if (raised) std::rethrow_exception(raised);
  if (failure) std::rethrow_exception(failure);
}

}  // namespace alidade::python
