#include "errors.h"

#include <cstring>
#include <deque>
#include <filesystem>
#include <mutex>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/run/run.h"
#include "python.h"

namespace alidade::python {
namespace {

constexpr size_t kMostWarnings = 1000;  // limit of collected warnings; the oldest are dropped

// Never destroyed, because threads may log warnings until the process ends.
struct Waiting {
  std::mutex mutex;
  std::deque<std::string> warnings;
};
Waiting& TheWaiting() {
  static Waiting* waiting = new Waiting;
  return *waiting;
}

std::deque<std::string> TakeWarnings() {
  Waiting& waiting = TheWaiting();
  const std::lock_guard<std::mutex> lock(waiting.mutex);
  return std::exchange(waiting.warnings, {});
}

void Raise(const char* name, const char* message) {
  const py::object type = py::module_::import("alidade.errors").attr(name);
  // paths in messages may have any encoding
  const py::object text = py::reinterpret_steal<py::object>(
      PyUnicode_DecodeUTF8(message, static_cast<Py_ssize_t>(std::strlen(message)), "replace"));
  PyErr_SetObject(type.ptr(), text.ptr());
}

const char* ExceptionFor(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kUsage:
      return "UsageError";
    case ErrorKind::kInput:
      return "InputError";
    case ErrorKind::kNothingMapped:
      return "NothingMapped";
  }
  return "Error";
}

void Translate(std::exception_ptr failure) {
  try {
    if (failure) std::rethrow_exception(failure);
  } catch (const ArrayError& error) {
    Raise("ArrayError", error.what());
  } catch (const Error& error) {
    Raise(ExceptionFor(error.kind()), error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    Raise("InputError", error.what());
  } catch (const RunStopped& stopped) {
    Raise("RunStopped", stopped.what());
  }
}

}  // namespace

void KeepWarning(const std::string& message) {
  Waiting& waiting = TheWaiting();
  const std::lock_guard<std::mutex> lock(waiting.mutex);
  waiting.warnings.push_back(message);
  if (waiting.warnings.size() > kMostWarnings) waiting.warnings.pop_front();
}

void CollectWarnings() { SetWarningListener(KeepWarning); }

void BindErrors(py::module_& core) {
  py::register_exception_translator(Translate);
  CollectWarnings();
  core.def("take_warnings", [] {
    py::list all;
    for (const std::string& text : TakeWarnings()) {
      all.append(py::reinterpret_steal<py::object>(
          PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "replace")));
    }
    return all;
  });
}

}  // namespace alidade::python
