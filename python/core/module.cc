// The module alidade._core: the library's classes and functions for the Python files in
// python/alidade. Contains no algorithms and is not part of the public interface.
#include "alidade/base/parallel.h"
#include "alidade/version.h"
#include "python.h"

PYBIND11_MODULE(_core, core) {
  core.doc() = "The C++ side of alidade; use the package, not this.";
  core.attr("version") = ALIDADE_VERSION;
  core.def("set_threads", &alidade::SetThreadCount, pybind11::arg("threads"));
  core.def("threads", &alidade::ThreadCount);
  alidade::python::BindErrors(core);
  alidade::python::BindCamera(core);
  alidade::python::BindSource(core);
  alidade::python::BindMap(core);
  alidade::python::BindRun(core);
  alidade::python::BindSlam(core);
  alidade::python::BindLocalize(core);
  alidade::python::BindEvaluate(core);
}
