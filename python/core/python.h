// Common declarations of the Python module: pybind11, and the binding functions.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

namespace alidade::python {

namespace py = pybind11;

void BindErrors(py::module_& core);    // alidade::Error as exceptions, warnings as text
void BindCamera(py::module_& core);    // Camera, and camera files
void BindSource(py::module_& core);    // recordings as arrays
void BindRun(py::module_& core);       // whole runs
void BindMap(py::module_& core);       // maps as arrays
void BindSlam(py::module_& core);      // frame by frame
void BindLocalize(py::module_& core);  // single pictures in a map
void BindEvaluate(py::module_& core);  // errors against the truth

}  // namespace alidade::python
